"""Tables and pictures of the page on modes and control, computed from the published derivatives of HORUS-2B.

python docs/modes_blocks.py      draw the pictures into docs/images/modes
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr

from spaceplane.aero.model.derivatives import Derivatives
from spaceplane.aero.model.published import horus_2b_published
from spaceplane.analysis.descent import Descent, DescentSettings, descend
from spaceplane.control.authority import Authority, authority
from spaceplane.control.closed_loop import close
from spaceplane.control.disturbance import Gust, disturbed, gust_column
from spaceplane.control.effort import efforts
from spaceplane.control.gramians import energy_to_rest
from spaceplane.control.holding import largest_held
from spaceplane.control.measures import controllable_rank, modal_control
from spaceplane.control.regulator import Regulator, bryson, minimum_effort
from spaceplane.control.saturation import saturated, takeover
from spaceplane.dynamics import derivatives_file
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import identify
from spaceplane.dynamics.response import doublet
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.dynamics.tracking import Branches, follow
from spaceplane.dynamics.trim.longitudinal import HORUS_2B_BODY_FLAP
from spaceplane.qualities.assess import load_factor_slope
from spaceplane.qualities.verdict import to_record
from spaceplane.report import control_tables
from spaceplane.report.control_record import control_record
from spaceplane.vehicle import presets

DOCS = Path(__file__).resolve().parent
IMAGES = DOCS / "images" / "modes"
CASE = derivatives_file.read(DOCS.parent / "examples" / "horus_2b_taem.toml")
TRIM = {"elevon_left": math.radians(-3.0), "elevon_right": math.radians(-3.0)}
THRUSTER = 1e4  # N m: a round number; those of HORUS-2B are not published
GUST = 10.0  # m/s
DESCENT_MACHS = (1.5, 2.0, 2.5, 3.0, 5.0, 10.0)
AXES = ("roll", "yaw")
UNITS = {"rad": ("deg", 180 / math.pi), "rad/s": ("deg/s", 180 / math.pi)}


@cache
def elevator_slopes() -> dict[str, float]:
    """CL, CD and Cm with both elevons, per rad: slopes of the published increments at the trim."""
    model = horus_2b_published()
    found = model.derivatives(CASE.point.mach, CASE.point.alpha, TRIM)
    return {f"{name}_elevator": found.control(name, "elevator") for name in ("CL", "CD", "Cm")}


def system(bank_deg: float | None = None, **changes: float) -> StateSpace:
    """HORUS-2B at the TAEM interface with an elevator; bank angle and derivatives (per rad) changed."""
    point = CASE.point if bank_deg is None else replace(CASE.point, bank=math.radians(bank_deg))
    return linearise(point, CASE.mass, CASE.reference, derivatives(**changes))


def derivatives(**changes: float) -> Derivatives:
    """Table 6.1 with the elevator and with changes, per rad."""
    controls = elevator_slopes() | {
        name: value for name, value in changes.items() if not hasattr(CASE.derivatives, name)
    }
    plain = {name: value for name, value in changes.items() if hasattr(CASE.derivatives, name)}
    return replace(CASE.derivatives, controls=controls, **plain)


def elevator() -> Authority:
    """The elevator from a trim of -3 deg."""
    return authority(["elevator"], TRIM)


def all_axes() -> Authority:
    """The elevator and thrusters about the roll and yaw axes."""
    return authority(["elevator", "moment_x", "moment_z"], TRIM, {"moment_x": THRUSTER, "moment_z": THRUSTER})


@cache
def along_stiffness() -> Branches:
    """Upright, from a stiff to an unstable C_m_alpha."""
    grid = np.linspace(-0.1, 0.1, 41)
    return follow(lambda x: system(0.0, Cm_alpha=x), grid, "Cm_alpha", "1/rad")


@cache
def along_bank() -> Branches:
    """From upright to 80 deg of bank."""
    return follow(lambda x: system(x), np.linspace(0.0, 80.0, 41), "bank", "deg")


def gust(axis: str, shape: str, duration: float = 0.0, strength: float = GUST) -> Gust:
    """A gust of `GUST` m/s, or as given."""
    column = gust_column(axis, CASE.point, CASE.mass, CASE.reference, derivatives())
    return Gust(shape, axis, strength / CASE.point.velocity, column, duration)


def table(head: tuple[str, ...], rows: list[tuple[str, ...]], left: int = 1) -> str:
    """Markdown; the first `left` columns to the left, the others to the right."""
    rule = ["---"] * left + ["---:"] * (len(head) - left)
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, tuple(rule), *rows))


def complex_text(value: complex) -> str:
    """An eigenvalue to three digits."""
    if abs(value.imag) < 1e-9:
        return f"{value.real:.3g}"
    return f"{value.real:.3g} ± {abs(value.imag):.3g}i" if abs(value.real) > 1e-9 else f"± {abs(value.imag):.3g}i"


def events(branches: Branches, digits: int) -> str:
    """Events other than names."""
    words = {"merge": "two roots become a pair", "split": "a pair splits", "stability": "crosses the imaginary axis"}
    rows = []
    for event in branches.events:
        if event.kind in words:
            before, after = (" and ".join(dict.fromkeys(names)) for names in (event.before, event.after))
            rows.append(
                (words[event.kind], before, after, f"{event.parameter:.{digits}f}", complex_text(event.eigenvalue))
            )
    return table(("event", "before", "after", str(branches.dataset["real"].dims[0]), "eigenvalue, 1/s"), rows, 3)


def names(branches: Branches) -> str:
    """Changes of name."""
    rows = [
        (event.branches[0].replace(" (upper)", ""), event.before[0], event.after[0], f"{event.parameter:.1f}")
        for event in branches.events
        if event.kind == "name"
    ]
    return table(("branch", "from", "to", str(branches.dataset["real"].dims[0])), rows, 3)


def stiffness_events() -> str:
    """Events along C_m_alpha."""
    return events(along_stiffness(), 4)


def bank_names() -> str:
    """Changes of name along the bank angle."""
    return names(along_bank())


def reach() -> str:
    """What elevator and thrusters can do to each mode."""
    plant, limits = system(), all_axes()
    rows = []
    for entry in modal_control(plant, limits):
        unit, factor = UNITS.get(entry.unit, (entry.unit, 1.0))
        cells = [f"{factor * entry.reach[name]:.3g}" for name in limits.inputs]
        rows.append((entry.mode.name, f"{entry.state}, {unit}", complex_text(entry.mode.eigenvalue), *cells))
    return table(("mode", "measured in", "eigenvalue, 1/s", *limits.inputs), rows, 2)


def held() -> str:
    """Rank, largest offset and least energy for two sets of inputs."""
    plant, rows = system(), []
    for text, limits in (("elevator", elevator()), ("elevator, thrusters in roll and yaw", all_axes())):
        bound = largest_held(plant, limits, {"alpha": 1.0})
        energy = [energy_to_rest(plant, limits, {name: math.radians(1.0)}) for name in ("alpha", "beta")]
        cells = (f"{math.degrees(bound.low):.1f} to {math.degrees(bound.high):.1f}", *(f"{x:.2g}" for x in energy))
        rows.append((text, str(controllable_rank(plant, limits)), *cells))
    head = ("inputs", "states moved", "offset in alpha held, deg", "energy for 1 deg of alpha, s", "of beta, s")
    return table(head, rows)


def disturbances() -> dict[str, dict]:
    """What the feedback is put to."""
    return {
        "offset of 1 deg in alpha": {"offsets": {"alpha": math.radians(1.0)}},
        f"sharp gust of {GUST:g} m/s from below": {"gust": gust("alpha", "sharp")},
        f"one-cosine gust of {GUST:g} m/s, 0.5 s": {"gust": gust("alpha", "one-cosine", 0.5)},
        f"sharp gust of {GUST:g} m/s from the right": {"gust": gust("beta", "sharp")},
    }


def feedback() -> dict[str, Regulator]:
    """The regulators compared."""
    excursions = {"alpha": math.radians(1), "beta": math.radians(1), "sigma": math.radians(5), "V": 20.0, "R": 500.0}
    return {
        "least effort": minimum_effort(system(), all_axes()),
        "Bryson": bryson(system(), all_axes(), excursions),
    }


def effort_table() -> str:
    """Peaks of deflection, rate and moment for each disturbance."""
    times, rows = np.linspace(0.0, 60.0, 12_001), []
    for kind, regulator in feedback().items():
        for text, what in disturbances().items():
            found = {e.name: e for e in efforts(disturbed(regulator, times, **what), regulator.limits)}
            elevon, roll, yaw = found["elevon_left"], found["moment_x"], found["moment_z"]
            rows.append(
                (
                    kind,
                    text,
                    f"{math.degrees(elevon.least):.1f} to {math.degrees(elevon.greatest):.1f}",
                    f"{math.degrees(elevon.rate):.1f}",
                    f"{max(abs(roll.least), roll.greatest) / 1e3:.2g}",
                    f"{max(abs(yaw.least), yaw.greatest) / 1e3:.2g}",
                    "yes" if all(e.within for e in found.values()) else "no",
                )
            )
    head = ("feedback", "disturbance", "elevons, deg", "rate, deg/s", "M_x, kN m", "M_z, kN m", "within limits")
    return table(head, rows, 2)


def closed_levels() -> str:
    """Levels of the open and closed loop."""
    area, weight = CASE.reference.area, CASE.mass.mass * 9.80665
    n_alpha = load_factor_slope(CASE.derivatives.CL_alpha, CASE.point.dynamic_pressure, area, weight)
    idle = minimum_effort(system(), all_axes())
    loops = {"open loop": replace(idle, gain=0 * idle.gain), **feedback()}
    verdicts = {text: close(regulator, n_alpha=n_alpha).verdicts for text, regulator in loops.items()}
    keys = list(dict.fromkeys((v.paragraph, v.criterion, v.quantity) for found in verdicts.values() for v in found))
    rows = []
    for key in keys:
        cells = []
        for found in verdicts.values():
            own = [v for v in found if (v.paragraph, v.criterion, v.quantity) == key]
            levels = ["n/a" if not v.applicable else f"level {v.level}".replace("level below", "below") for v in own]
            cells.append(", ".join(dict.fromkeys(levels)) or "-")
        rows.append((key[0], f"{key[1]}: {key[2]}", *cells))
    return table(("paragraph", "criterion", *verdicts), rows, 2)


def thrusters() -> str:
    """Thruster moment beside rudders of assumed effectiveness."""
    rows, times = [], np.linspace(0.0, 40.0, 4001)
    for effect in (-0.0005, -0.001, -0.002, -0.005):
        run = rudder_run(effect, times)
        moment = np.abs(run["moment_z"].values)
        rows.append(
            (
                f"{effect:g}",
                f"{math.degrees(np.abs(run['rudder'].values).max()):.1f}",
                f"{moment.max() / 1e3:.2g}",
                f"{np.trapezoid(moment, run['time'].values) / 1e3:.2g}",
            )
        )
    head = ("C_n_rudder, 1/rad", "rudder, deg", "greatest thruster moment, kN m", "its impulse, kN m s")
    return table(head, rows)


def rudder_run(effect: float, times: np.ndarray) -> xr.Dataset:
    """A lateral gust met by elevator and rudder, thrusters taking over beyond the rudder's limit."""
    plant = system(Cn_rudder=effect)
    excursions = {"alpha": math.radians(1), "beta": math.radians(1), "sigma": math.radians(5), "V": 20.0, "R": 500.0}
    regulator = bryson(plant, authority(["elevator", "rudder"], TRIM), excursions)
    return saturated(
        regulator, times, gust=gust("beta", "sharp", strength=30.0), reliefs=[takeover(plant, "rudder", "moment_z")]
    )


@cache
def descent() -> Descent:
    """The published tables along some of their Mach numbers."""
    return descend(
        horus_2b_published(), presets.horus_2b().mass, DescentSettings(DESCENT_MACHS, body_flap=HORUS_2B_BODY_FLAP)
    )


def descent_table() -> str:
    """By Mach number: the fastest growth, what is held, what the feedback asks and the levels."""
    rows = []
    for one in descent().points:
        record = control_record(one.control, histories=False)
        asked = {peak.name: peak for peak in control_tables.asked(record["disturbances"])}
        elevons = asked["elevons"]
        moments = (f"{max(-asked[f'{axis} thruster'].least, asked[f'{axis} thruster'].greatest):.2f}" for axis in AXES)
        before = control_tables.worst_text(control_tables.open_verdicts([to_record(v) for v in one.verdicts]))
        rows.append(
            (
                f"{one.point.mach:g}",
                f"{max(mode['eigenvalue'][0] for mode in record['modes']):.3f}",
                control_tables.held_text(record, "alpha"),
                control_tables.range_text(elevons),
                f"{elevons.rate:.1f}",
                *moments,
                before,
                control_tables.worst_text(record["closed_loop"]["verdicts"]),
            )
        )
    head = ("Mach", "fastest growth, 1/s", "alpha held, deg", "elevons, deg", "rate, deg/s", "M_x, kN m", "M_z, kN m")
    return table((*head, "worst level, controls fixed", "with feedback"), rows)


BLOCKS: dict[str, Callable[[], str]] = {
    "control descent": descent_table,
    "modes along stiffness": stiffness_events,
    "modes along bank": bank_names,
    "control reach": reach,
    "control held": held,
    "control effort": effort_table,
    "control levels": closed_levels,
    "control thrusters": thrusters,
}


def pictures() -> dict[str, bytes]:
    """{name: PNG}."""
    from spaceplane.report.control_figures import motions
    from spaceplane.report.figures_dynamics import over_parameter, phasors, responses, root_locus

    plant = system()
    times = np.linspace(0.0, 6.0, 601)
    regulators = feedback()
    gusted = {text: disturbed(regulator, times, gust=gust("alpha", "sharp")) for text, regulator in regulators.items()}
    shown = [m for m in identify(plant) if abs(m.eigenvalue) > 0]
    free = {"upright, C_m_alpha = -0.1": doublet(system(0.0, Cm_alpha=-0.1), "elevator", math.radians(1), 2.0, times)}
    free["bank 55 deg, published C_m_alpha"] = doublet(plant, "elevator", math.radians(1), 2.0, times)
    low, high = elevator().low[0], elevator().high[0]
    fastest = next(one for one in descent().points if one.point.mach == 2.5)
    return {
        "root_locus_stiffness": root_locus(
            along_stiffness(), [(-1.6, 1.6, 2.0), (-0.12, 0.16, 0.06)], "C_m_alpha, 1/rad"
        ),
        "along_stiffness": over_parameter(along_stiffness(), "C_m_alpha, 1/rad", (-0.6, 0.6)),
        "root_locus_bank": root_locus(along_bank(), [(-1.3, 1.3, 1.6), (-0.10, 0.05, 0.045)], "bank angle, deg"),
        "phasors": phasors(shown, CASE.point.velocity),
        "descent_responses": motions(control_record(fastest.control)["responses"]),
        "doublet": responses(free, ["alpha", "q", "V", "elevator"]),
        "gust": responses(gusted, ["alpha", "q", "elevator", "elevator_rate"], {"elevator": (low, high)}),
    }


if __name__ == "__main__":
    IMAGES.mkdir(parents=True, exist_ok=True)
    for name, data in pictures().items():
        (IMAGES / f"{name}.png").write_bytes(data)
        print(IMAGES / f"{name}.png")
