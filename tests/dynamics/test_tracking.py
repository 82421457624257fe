"""Modes followed along a parameter: identity through crossings, mergers and splits whose places are known exactly."""

import math

import numpy as np
import pytest

from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import identify
from spaceplane.dynamics.statespace import StateSpace, from_matrix
from spaceplane.dynamics.tracking import follow, interpolated
from spaceplane.errors import InputError

from . import horus
from .test_modes import B747_LATERAL

MIX = np.array([[1.0, 2.0, 0.3, 0.1], [0.0, 1.0, 0.5, -0.4], [0.2, 0.0, 1.0, 0.6], [0.3, -0.2, 0.1, 1.0]])


def mixed(matrix, states=("alpha", "q", "p", "beta")):
    """The same eigenvalues with every state taking part."""
    n = len(matrix)
    T = MIX[:n, :n]
    return from_matrix(T @ matrix @ np.linalg.inv(T), states[:n])


def horus_system(**changes):
    point = {key: changes.pop(key) for key in ("bank_deg", "alpha_deg", "mach") if key in changes}
    return linearise(horus.point(**point), horus.MASS, horus.REFERENCE, horus.derivatives(**changes))


@pytest.mark.parametrize("points", [2, 5, 8, 33])
def test_oscillator_from_overdamped_to_underdamped(points):
    """l2 + 2 z l + 1: two real roots merge at z = 1, on the grid or off it; the place is that of the formula."""

    def system(z):
        return from_matrix(np.array([[0.0, 1.0], [-1.0, -2.0 * z]]), ("alpha", "q"))

    branches = follow(system, np.linspace(0.2, 1.8, points), "damping")
    kinds = [event.kind for event in branches.events if event.kind != "name"]
    assert kinds == ["split"]
    split = next(event for event in branches.events if event.kind == "split")
    assert split.parameter == pytest.approx(1.0, abs=1e-12)
    assert split.eigenvalue == pytest.approx(-1.0, abs=1e-6)
    z = branches.dataset["damping"].values
    exact = -z + np.sqrt(z.astype(complex) ** 2 - 1)
    assert branches.eigenvalues()[:, 0] == pytest.approx(exact, abs=3e-8)  # the upper half goes on as the slower root
    assert list(branches.dataset["damping"].values[branches.dataset["given"].values]) == pytest.approx(
        np.linspace(0.2, 1.8, points)
    )


@pytest.mark.parametrize("points", [2, 3, 4, 11])
def test_crossing_without_exchange(points):
    """Two uncoupled real roots pass each other, and a third; on the grid for odd numbers of points."""
    branches = follow(lambda t: mixed(np.diag([t - 2, -1 - t, -1.5])), np.linspace(0.0, 1.0, points), "t")
    t, values = branches.dataset["t"].values, branches.eigenvalues()
    for exact in (t - 2, -1 - t, -1.5 + 0 * t):
        branch = int(np.argmin(np.abs(values[0] - exact[0])))
        assert values[:, branch] == pytest.approx(exact, abs=1e-9)
    assert not [e for e in branches.events if e.kind != "name"]


def test_avoided_crossing_keeps_the_continuous_root():
    """A symmetric coupling repels the roots: upper stays upper, through any rotation of the eigenvectors."""
    for coupling in (0.1, 1e-3):
        branches = follow(
            lambda t, c=coupling: from_matrix(np.array([[t - 2, c], [c, -1 - t]]), ("alpha", "p")),
            np.linspace(0.0, 1.0, 6),
            "t",
        )
        t, values = branches.dataset["t"].values, branches.eigenvalues().real
        half = np.sqrt((t - 0.5) ** 2 + coupling**2)
        upper = int(np.argmax(values[0]))
        assert values[:, upper] == pytest.approx(-1.5 + half, abs=1e-12)
        assert values[:, 1 - upper] == pytest.approx(-1.5 - half, abs=1e-12)


def test_bubble_of_an_oscillation_merges_and_splits():
    """Opposite coupling: real roots, then a pair for |t - 1/2| < c, then real again, beside a bystander."""
    c = 0.2

    def system(t):
        matrix = np.diag([t - 2, -1 - t, -1.6 + 0.2 * t, -3.0])
        matrix[0, 1], matrix[1, 0] = c, -c
        return mixed(matrix)

    branches = follow(system, np.linspace(0.0, 1.0, 9), "t")
    events = [e for e in branches.events if e.kind in ("merge", "split")]
    assert [e.kind for e in events] == ["merge", "split"]
    assert [e.parameter for e in events] == pytest.approx([0.5 - c, 0.5 + c], abs=1e-12)
    assert events[0].branches == events[1].branches
    t, values = branches.dataset["t"].values, branches.eigenvalues()
    half = np.sqrt((t - 0.5) ** 2 - c**2 + 0j)
    first, second = (list(branches.dataset["branch"].values).index(b) for b in events[0].branches)
    assert values[:, first] == pytest.approx(-1.5 + half, abs=1e-7)
    assert values[:, second] == pytest.approx(-1.5 - half, abs=1e-7)
    partner = branches.dataset["partner"].values
    inside = np.abs(t - 0.5) < c - 1e-9
    assert (partner[inside, first] == second).all() and (partner[~inside, first] == first).all()


def test_events_have_the_names_just_beside_them():
    """One wide step: the oscillation turns unstable at 0.2 and splits at 0.6, and is no divergence in between."""

    def system(t):
        return from_matrix(np.array([[t - 0.2, 1.0], [4 * (t - 0.6), t - 0.2]]), ("alpha", "q"))

    stability, split = [e for e in follow(system, (0.0, 1.0), "t").events if e.kind in ("stability", "split")][:2]
    assert (stability.kind, stability.parameter) == ("stability", pytest.approx(0.2))
    assert stability.before == stability.after == ("short period",)
    assert (split.kind, split.parameter) == ("split", pytest.approx(0.6))
    assert set(split.before) == {"short period"} and set(split.after) == {"aperiodic pitch divergence"}


def test_stability_is_found_where_it_changes():
    branches = follow(
        lambda t: mixed(np.array([[t, 2.0, 0.0], [-2.0, t, 0.0], [0.0, 0.0, t - 0.3]])), np.linspace(-1, 1, 4), "t"
    )
    found = sorted((e.parameter, e.eigenvalue.imag) for e in branches.events if e.kind == "stability")
    assert np.array(found) == pytest.approx(np.array([(0.0, 2.0), (0.3, 0.0)]), abs=1e-12)
    exact = follow(lambda t: from_matrix(np.array([[t]]), ("p",)), np.linspace(-1, 1, 5), "t")
    assert [(e.kind, e.parameter) for e in exact.events if e.kind == "stability"] == [("stability", 0.0)]


def test_double_root_all_along_is_followed():
    """Two equal uncoupled motions never have eigenvectors of their own; the rest is followed all the same."""
    branches = follow(lambda t: mixed(np.diag([-1.0 - t, -1.0 - t, 0.5 * t])), np.linspace(0.0, 1.0, 5), "t")
    t = branches.dataset["t"].values
    values = np.sort(branches.eigenvalues().real, axis=1)
    assert values[:, 2] == pytest.approx(0.5 * t, abs=1e-9)
    assert values[:, :2] == pytest.approx(np.stack([-1 - t, -1 - t], axis=1), abs=1e-7)
    assert "unresolved" not in {e.kind for e in branches.events}


def test_units_and_order_of_states_do_not_matter():
    """The branches and their events are the same with other units and another order of the states."""
    scale, order = np.diag([3e-3, 57.3, 1e3, 0.2, 7.0, 1e-2, 4.0, 90.0, 0.5]), [3, 1, 8, 0, 2, 7, 6, 5, 4]

    def other(bank):
        system = horus_system(bank_deg=bank)
        matrix = (scale @ system.A @ np.linalg.inv(scale))[np.ix_(order, order)]
        return from_matrix(matrix, tuple(system.states[k] for k in order))

    grid = np.linspace(0.0, 80.0, 9)
    a, b = follow(lambda x: horus_system(bank_deg=x), grid, "bank"), follow(other, grid, "bank")
    assert a.dataset["branch"].values.tolist() == b.dataset["branch"].values.tolist()
    given = [x.eigenvalues()[x.dataset["given"].values] for x in (a, b)]
    assert given[0] == pytest.approx(given[1], abs=1e-9)
    assert [(e.kind, e.branches) for e in a.events] == [(e.kind, e.branches) for e in b.events]
    assert [e.parameter for e in a.events] == pytest.approx([e.parameter for e in b.events], abs=1e-4)


def test_fine_and_coarse_grids_agree():
    """HORUS-2B from a stiff to an unstable C_m_alpha: the same branches and events on 6, 21 and 81 points."""
    results = [
        follow(lambda x: horus_system(Cm_alpha=x), np.linspace(-0.1, 0.1, points), "Cm_alpha") for points in (6, 21, 81)
    ]
    fine = results[-1]
    for coarse in results[:-1]:
        assert coarse.dataset["branch"].values.tolist() == fine.dataset["branch"].values.tolist()
        ends = [x.eigenvalues()[-1] for x in (coarse, fine)]
        assert ends[0] == pytest.approx(ends[1], abs=1e-9)
        for kind in ("merge", "split", "stability"):
            places = [[e.parameter for e in x.events if e.kind == kind] for x in (coarse, fine)]
            assert places[0] == pytest.approx(places[1], abs=1e-9), kind


def test_short_period_of_horus_splits_into_divergence():
    """As C_m_alpha grows the short period slows, loses its damping and splits; one half is the pitch divergence."""
    branches = follow(lambda x: horus_system(Cm_alpha=x), np.linspace(-0.1, 0.1, 21), "Cm_alpha")
    label = "short period (upper)"
    events = [(e.kind, e.before[0], e.after[0]) for e in branches.events if label in e.branches]
    assert events[0] == ("stability", "short period", "short period")
    split = next(e for e in branches.events if e.kind == "split" and label in e.branches)
    assert split.branches == (label, "short period (lower)")
    last = branches.dataset.sel(branch=label).isel(Cm_alpha=-1)
    assert str(last["name"].values) == "aperiodic pitch divergence"
    values = np.linalg.eigvals(horus_system(Cm_alpha=split.parameter).A)
    pair = values[np.argsort(np.abs(values - split.eigenvalue))[:2]]
    assert abs(pair[0] - pair[1]) < 1e-5  # a double root, to the square root of round-off
    jumps = np.abs(np.diff(branches.eigenvalues(), axis=0)).max()
    assert jumps < 0.35


def test_bank_couples_lateral_and_longitudinal_motion():
    """Upright no mode mixes the two groups; in bank some do, and say so from where on."""
    branches = follow(lambda x: horus_system(bank_deg=x), np.linspace(0.0, 80.0, 17), "bank_deg", "deg")
    share = branches.dataset["participation"].sel(state=["p", "r", "beta", "sigma"]).sum("state")
    upright = share.isel(bank_deg=0).values
    assert np.minimum(upright, 1 - upright).max() < 1e-9
    banked = share.sel(bank_deg=55.0).values
    assert np.minimum(banked, 1 - banked).max() > 0.2
    coupled = [e for e in branches.events if e.kind == "name" and any("pitch/roll" in name for name in e.after)]
    assert coupled and all(0.0 < e.parameter < 80.0 for e in coupled)
    for event in coupled:  # the name is the old one just before and the new one just after
        for shift, names in ((-1e-3, event.before), (1e-3, event.after)):
            modes = identify(horus_system(bank_deg=event.parameter + shift))
            assert min(modes, key=lambda m: abs(m.eigenvalue - event.eigenvalue)).name == names[0]


def test_yaw_damper_of_the_boeing_747():
    """Rudder from yaw rate: the damping ratio of the Dutch roll peaks at 0.45 with a gain of 2.85, as the yaw damper
    example of the MATLAB control toolbox finds (A and rudder column after Heffley and Jewell 1972)."""
    rudder, rate = np.array([0.00729, -0.475, 0.153, 0.0]), np.array([0.0, 1.0, 0.0, 0.0])

    def system(gain):
        return from_matrix(B747_LATERAL + gain * np.outer(rudder, rate), ("beta", "r", "p", "phi"))

    branches = follow(system, np.linspace(0.0, 6.0, 13), "gain")
    labels = branches.dataset["branch"].values.tolist()
    assert labels == ["Dutch roll (upper)", "Dutch roll (lower)", "roll mode", "spiral"]
    values = branches.eigenvalues()
    for gain, row in zip(branches.dataset["gain"].values, values, strict=True):
        exact = np.linalg.eigvals(system(gain).A)
        assert np.abs(row[:, None] - exact[None, :]).min(axis=0).max() < 1e-9
    damping = -values[:, 0].real / np.abs(values[:, 0])
    best = int(np.argmax(damping))
    assert damping[best] == pytest.approx(0.45, abs=0.01)
    assert branches.dataset["gain"].values[best] == pytest.approx(2.85, abs=0.3)
    assert (np.diff(values[:, 3].real) < 0).all()  # the spiral only speeds up
    assert {e.kind for e in branches.events} == {"name"}


def test_interpolated_family():
    systems = [horus_system(mach=mach) for mach in (2.0, 2.5, 3.0)]
    family = interpolated([2.0, 2.5, 3.0], systems)
    for mach, system in zip((2.0, 2.5, 3.0), systems, strict=True):
        assert np.allclose(family(mach).A, system.A, rtol=1e-14, atol=0)
    assert np.allclose(family(2.25).A, (systems[0].A + systems[1].A) / 2, rtol=1e-14, atol=0)
    with pytest.raises(InputError, match=r"parameter = 3\.1.*between 2 and 3"):
        family(3.1)
    with pytest.raises(InputError, match="systems: 2 given for 3"):
        interpolated([1.0, 2.0, 3.0], systems[:2])
    branches = follow(family, [2.0, 2.5, 3.0], "mach")
    assert np.sort_complex(branches.eigenvalues()[0]) == pytest.approx(
        np.sort_complex(np.linalg.eigvals(systems[0].A)), abs=1e-9
    )


@pytest.mark.parametrize(
    ("grid", "parameter", "message"),
    [
        ([1.0], "t", "grid"),
        ([0.0, 0.0], "t", "grid"),
        ([0.0, math.nan], "t", "grid"),
        ([0.0, 1.0], "state", "parameter = 'state'"),
    ],
)
def test_refuses(grid, parameter, message):
    with pytest.raises(InputError, match=message):
        follow(lambda t: mixed(np.diag([t, 1 - t])), grid, parameter)


def test_refuses_states_that_change():
    def system(t):
        names = ("alpha", "q") if t < 0.9 else ("q", "alpha")
        return StateSpace(np.diag([t, -1.0]), np.zeros((2, 0)), names)

    with pytest.raises(InputError, match="states at 1"):
        follow(system, [0.0, 1.0], "t")
