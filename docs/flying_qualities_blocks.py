"""The generated blocks of the page on flying qualities; run as a script it draws that page's picture.

python docs/flying_qualities_blocks.py     writes docs/images/departure.png
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path

import numpy as np
from blocks import demo, table

DRAWS = 500


@lru_cache(maxsize=1)
def points() -> tuple[tuple, ...]:
    """(name, airframe, uncertainty) of the demo's flight points, from its stored derivatives and their errors."""
    from spaceplane.aero.model.derivatives import from_mapping
    from spaceplane.dynamics.flightpoint import taem_point
    from spaceplane.qualities.airframe import Airframe
    from spaceplane.qualities.probability import Uncertainty, mirror_correlation
    from spaceplane.vehicle.properties import HORUS_MASS, HORUS_REFERENCE

    found = []
    deflections = demo()["vehicle"]["deflections_deg"]
    elevator = math.radians(0.5 * (deflections["elevon_left"] + deflections["elevon_right"]))
    for p in demo()["flight_points"]:
        at = taem_point(p["mach"], p["altitude_m"], p["alpha_deg"])
        at = at.with_coefficients(p["coefficients"]["CL"], p["coefficients"]["CD"])
        derivatives = from_mapping({name: d["value"] for name, d in p["derivatives"].items()})
        half_width = {name: d["error"] for name, d in p["derivatives"].items() if d["error"]}
        uncertainty = Uncertainty(half_width, mirror_correlation(derivatives, half_width))
        airframe = Airframe(at, HORUS_MASS, HORUS_REFERENCE, derivatives, p["coefficients"]["Cm"], elevator)
        found.append((p["name"], airframe, uncertainty))
    return tuple(found)


def likely_levels() -> str:
    """Most likely outcome of each criterion at the demo's flight points; only what applies somewhere."""
    from spaceplane.qualities.probability import outlooks

    columns = [_likely(outlooks(a, u, samples=DRAWS)) for _, a, u in points()]
    keys = dict.fromkeys(key for column in columns for key in column)
    rows = [
        (*key, *(column.get(key, "-") for column in columns))
        for key in keys
        if any(column.get(key, "-") != "-" for column in columns)
    ]
    return table(("criterion", "quantity", *(name for name, _, _ in points())), rows)


def _likely(found: tuple) -> dict[tuple[str, str], str]:
    from spaceplane.qualities.probability import per_cent

    texts = {}
    for one in found:
        name = max(one.probabilities, key=one.probabilities.get)
        said = "-" if name == "not applicable" else f"level {name}" if name in "123" else name
        share = f", {per_cent(one.probabilities[name])}" if one.probabilities[name] < 1 else ""
        texts.setdefault((one.verdict.criterion, one.verdict.quantity), said + (share if said != "-" else ""))
    return texts


def mode_drivers() -> str:
    """Every mode of the demo's last flight point with the error of its eigenvalue and what causes it."""
    from spaceplane.dynamics.linearise import linearise
    from spaceplane.dynamics.modes import identify
    from spaceplane.dynamics.sensitivity import drivers, eigenvalue_error, of_model
    from spaceplane.qualities.probability import NORMAL_95

    _, a, u = points()[-1]
    model = (a.point, a.mass, a.reference, a.derivatives)
    system = linearise(*model)
    modes = identify(system)
    rows = []
    for mode, one in zip(modes, of_model(*model, system.A, modes), strict=True):
        errors = [NORMAL_95 * sigma for sigma in eigenvalue_error(one, u.covariance(one.parameters))]
        causes = _shares(drivers(one, u.half_width)), _shares(drivers(one))
        rows.append((mode.name, *_complex(mode.eigenvalue, errors), *causes))
    return table(("mode", "eigenvalue, 1/s", "95 %", "uncertain by", "moved most by 1 % of"), rows)


def _complex(value: complex, errors: list[float]) -> Iterator[str]:
    real, imaginary = value.real, value.imag
    yield f"{real:.4g}" + (f" ± {imaginary:.4g}i" if imaginary else "")
    yield f"{errors[0]:.2g}" + (f", {errors[1]:.2g}i" if imaginary else "")


def _shares(found: tuple) -> str:
    return ", ".join(f"{d.parameter} {100 * d.share:.0f} %" for d in found[:3] if d.share >= 0.01) or "-"


def requirements() -> str:
    """Limits on the airframe for class III, category B, as the program holds them."""
    from spaceplane.qualities import limits
    from spaceplane.qualities.roll_figures import curve_limits

    spec = limits.specification()
    roll = spec["roll_control"]["B"]["III"]
    slip, rate = spec["sideslip_excursion"]["B"], spec["roll_rate_oscillation"]["B"]
    path = spec["path_stability"]["slope_high_deg_per_knot"]
    growth = spec["path_stability_below"]["change_high_deg_per_knot"]
    small, bank = (curve_limits(name, "B", None) for name in ("roll_rate_oscillation_small", "bank_oscillation"))
    rows = [
        ("path_stability", "path angle over airspeed (category C), deg/knot", *(f"<= {x:g}" for x in path)),
        ("path_stability_below", "growth of it towards 5 knots slower (category C), deg/knot", *[f"<= {growth:g}"] * 3),
        ("roll_rate_oscillation", "roll rate, first minimum over first peak", *(f">= {x:g}" for x in rate), "-"),
        ("roll_rate_oscillation_small", "p_osc / p_av, least of figure 4", *(f"<= {x:g}" for x in small), "-"),
        ("bank_oscillation", "phi_osc / phi_av, least of figure 5", *(f"<= {x:g}" for x in bank), "-"),
        *(
            ("sideslip_excursion", f"{side} sideslip per k, deg", *(f"<= {x:g}" for x in slip[side]), "-")
            for side in ("adverse", "proverse")
        ),
        *(
            ("roll_control", f"time to bank by 30 deg, speed range {name}, s", *(f"<= {x:g}" for x in roll[name]))
            for name in "LMH"
        ),
    ]
    share = f"<= {spec['dihedral_limit']['share_high_percent']:g}"
    rows.append(("dihedral_limit", "share of the aileron at 10 deg of sideslip, %", share, share, "-"))
    rows = [(spec[key]["paragraph"], *row) for key, *row in rows]
    return table(("paragraph", "quantity", "level 1", "level 2", "level 3"), rows)


def write_picture(path: Path) -> Path:
    """The demo's flight points in the plane of LCDP and C_n_beta,dyn, with errors to first order."""
    from spaceplane.dynamics.sensitivity import moved_by
    from spaceplane.qualities.departure import dynamic_directional, lateral_control_departure
    from spaceplane.report.departure_plot import DeparturePoint, write_departure_plot

    found = {}
    for name, a, u in points():
        values = (
            lateral_control_departure(a.derivatives, a.mass),
            dynamic_directional(a.derivatives, a.mass, a.point.alpha),
        )
        changes = []
        for label in u.names:
            moved = moved_by({label: u.half_width[label]}, a.point, a.derivatives)[1]
            pair = lateral_control_departure(moved, a.mass), dynamic_directional(moved, a.mass, a.point.alpha)
            changes.append([after - before for after, before in zip(pair, values, strict=True)])
        errors = [math.sqrt(change @ u.matrix() @ change) for change in np.array(changes).T]
        found[name] = DeparturePoint(*values, *errors)
    return write_departure_plot(found, path)


BLOCKS: dict[str, Callable[[], str]] = {
    "airframe requirements": requirements,
    "demo outlook": likely_levels,
    "demo drivers": mode_drivers,
}

if __name__ == "__main__":
    print(write_picture(Path(__file__).parent / "images" / "departure.png"))
