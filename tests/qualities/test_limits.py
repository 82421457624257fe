"""Every limit of the data file against tables of MIL-F-8785C, entered a second time, in the tables' own grouping."""

import math

import pytest

from spaceplane.qualities import limits
from spaceplane.qualities.roll_control import requirement
from spaceplane.qualities.verdict import Context

# (category, classes) -> what the tables print. Classes L are land-based, C carrier-based.
SHORT_PERIOD = {  # table IV: least and greatest damping ratio
    "AC": ((0.35, 0.25, 0.15), (1.30, 2.00)),
    "B": ((0.30, 0.20, 0.15), (2.00, 2.00)),
}
ANTICIPATION = {  # figures 1 to 3: omega^2 / (n/alpha)
    "A": ((0.28, 0.16, 0.16), (3.6, 10.0)),
    "B": ((0.085, 0.038, 0.038), (3.6, 10.0)),
    "C": ((0.16, 0.096, 0.096), (3.6, 10.0)),
}
DUTCH_ROLL = [  # table VI: damping ratio, product, frequency at level 1
    ("A", ("I", "IV"), 0.19, 0.35, 1.0),
    ("A", ("II-L", "II-C", "III"), 0.19, 0.35, 0.4),
    ("B", limits.CLASSES, 0.08, 0.15, 0.4),
    ("C", ("I", "II-C", "IV"), 0.08, 0.15, 1.0),
    ("C", ("II-L", "III"), 0.08, 0.10, 0.4),
]
ROLL = [  # table VII: greatest time constant, s. Category A does not part II-C from II-L
    ("A", ("I", "IV"), (1.0, 1.4, 10.0)),
    ("A", ("II-L", "II-C", "III"), (1.4, 3.0, 10.0)),
    ("B", limits.CLASSES, (1.4, 3.0, 10.0)),
    ("C", ("I", "II-C", "IV"), (1.0, 1.4, 10.0)),
    ("C", ("II-L", "III"), (1.4, 3.0, 10.0)),
]
SPIRAL = {"AC": (12.0, 8.0, 4.0), "B": (20.0, 8.0, 4.0)}  # table VIII: least time to double, s


def test_phugoid_and_static_stability():
    spec = limits.specification()
    assert spec["phugoid"]["damping_ratio_low"] == [0.04, 0.0]
    assert spec["phugoid"]["double_time_low_s"] == 55.0
    assert spec["static_stability"]["double_time_low_s"] == 6.0


@pytest.mark.parametrize("vehicle_class", limits.CLASSES)
@pytest.mark.parametrize("category", limits.CATEGORIES)
def test_tables_of_classes_and_categories(vehicle_class, category):
    lows, highs = next(row for key, row in SHORT_PERIOD.items() if category in key)
    found = limits.of("short_period_damping", category, vehicle_class)
    assert (tuple(found["low"]), tuple(found["high"])) == (lows, highs)
    found = limits.of("short_period_frequency", category, vehicle_class)
    assert (tuple(found["low"]), tuple(found["high"])) == ANTICIPATION[category]
    zeta, product, omega = next(row[2:] for row in DUTCH_ROLL if row[0] == category and vehicle_class in row[1])
    found = limits.of("dutch_roll", category, vehicle_class)
    assert found == {"zeta": [zeta, 0.02, 0.0], "zeta_omega": [product, 0.05], "omega": [omega, 0.4, 0.4]}
    times = next(row[2] for row in ROLL if row[0] == category and vehicle_class in row[1])
    assert tuple(limits.of("roll", category, vehicle_class)) == times
    double = next(row for key, row in SPIRAL.items() if category in key)
    assert tuple(limits.of("spiral", category, vehicle_class)) == double


def test_least_frequencies_and_load_factors():
    """Figure 1 for every class; figure 3 for classes II-L and III, and for the others."""
    spec = limits.specification()["short_period_frequency"]
    assert spec["A"]["frequency_low"] == [1.0, 0.6] and "frequency_low" not in spec["B"]
    for vehicle_class in limits.CLASSES:
        heavy = vehicle_class in ("II-L", "III")
        assert spec["C"]["frequency_low"][vehicle_class] == ([0.7, 0.4] if heavy else [0.87, 0.6])
        assert spec["C"]["load_low"][vehicle_class] == ([2.0, 1.0] if heavy else [2.7, 1.8])


CLASS_IV = {  # table IXb: bank angle change, deg, and times at levels 1 to 3 by category and speed range
    ("A", "VL"): (30, 1.1, 1.6, 2.6),
    ("A", "L"): (30, 1.1, 1.5, 2.0),
    ("A", "M"): (90, 1.3, 1.7, 2.6),
    ("A", "H"): (50, 1.1, 1.3, 2.6),
    ("B", "VL"): (90, 2.0, 2.8, 3.7),
    ("B", "L"): (90, 1.7, 2.5, 3.4),
    ("B", "M"): (90, 1.7, 2.5, 3.4),
    ("B", "H"): (90, 1.7, 2.5, 3.4),
    **{("C", speed): (30, 1.1, 1.3, 2.0) for speed in ("VL", "L", "M", "H")},
}


def test_time_to_bank_of_class_iv():
    for (category, speed), (bank, *times) in CLASS_IV.items():
        angle, found = requirement(Context("IV", category), speed)
        assert math.degrees(angle) == pytest.approx(bank) and list(found) == times


def test_limits_loosen_with_the_level():
    """Whatever is asked at level 1 is asked no more strictly at level 2, nor at 3."""
    spec = limits.specification()
    for category in limits.CATEGORIES:
        for vehicle_class in limits.CLASSES:
            row = spec["roll_control"][category][vehicle_class]
            for times in (value for key, value in row.items() if key != "bank_deg"):
                assert times == sorted(times)
        for side in ("adverse", "proverse"):
            assert spec["sideslip_excursion"][category][side] == sorted(spec["sideslip_excursion"][category][side])
        least = spec["roll_rate_oscillation"][category]
        assert least == sorted(least, reverse=True)


def test_regions_of_the_departure_plane_cover_it_once():
    regions = {k: v for k, v in limits.departure()["regions"].items() if isinstance(v, dict)}
    for lcdp in (-0.01, -1e-9, 0.0, 0.01):
        for directional in (-0.01, 0.0, 0.002, 0.004, 0.01):
            inside = [
                name
                for name, r in regions.items()
                if r["lcdp"][0] <= lcdp < r["lcdp"][1] and r["directional"][0] <= directional < r["directional"][1]
            ]
            assert len(inside) == 1
