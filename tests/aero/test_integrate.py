import math
from dataclasses import replace

import numpy as np
import pytest

from spaceplane.aero.integrate import COEFFICIENTS, PRESSURES, WITH_SPREAD, integrate, mirrored, wetted_area


def total(data, name, condition=0):
    return float(data[name].sel(part="total").values[condition])


def smooth(center, mach, alpha, beta):
    x, y, z = center.T
    return np.cos(x + 0.3) - alpha * z * 3.0 + np.sin(2.0 * y + 1.0) * (0.2 + beta) + 0.1 * mach * x * z


def test_uniform_pressure_gives_no_force(make_solution, box, lengths):
    data = integrate(make_solution(box, lambda c, *_: np.full(len(c), 0.7), alpha=0.3, beta=0.2), lengths)
    for name in ("CL", "CD", "CY", "Cl", "Cm", "Cn", "CA", "CN"):
        assert abs(total(data, name)) < 1e-13
    # It pushes the front aft and the base forward with the box's cross section, 2 x 1 of 8 m2.
    assert total(data, "CA_forebody") == pytest.approx(0.7 * 2.0 / 8.0)
    assert total(data, "CA_base") == pytest.approx(-0.7 * 2.0 / 8.0)


def test_parts_sum_to_the_total(make_solution, box, lengths):
    data = integrate(make_solution(box, smooth, mach=[0.8, 3.0], alpha=[0.1, 0.4], beta=[0.05, 0.0]), lengths)
    for name in COEFFICIENTS:
        parts = data[name].drop_sel(part="total").sum("part")
        np.testing.assert_allclose(parts, data[name].sel(part="total"), atol=1e-14)
    np.testing.assert_allclose(data.CA_forebody + data.CA_base, data.CA, atol=1e-14)


@pytest.mark.parametrize(
    ("pushed", "name", "sign"),
    [
        (lambda x, y, z: z < -0.49, "CL", 1),  # more pressure below lifts
        (lambda x, y, z: x < -1.9, "CD", 1),  # on the nose drags
        (lambda x, y, z: y < -0.9, "CY", 1),  # on the left side pushes right
        (lambda x, y, z: (z < -0.49) & (y < 0), "Cl", 1),  # below the left wing rolls right wing down
        (lambda x, y, z: (z < -0.49) & (x < 0), "Cm", 1),  # below the nose pitches up
        (lambda x, y, z: (y < -0.9) & (x < 0), "Cn", 1),  # on the left of the nose yaws nose right
        (lambda x, y, z: x > 1.9, "CA_base", -1),  # on the base pushes forward
        (lambda x, y, z: z > 0.49, "CN", -1),
    ],
)
def test_axis_signs(make_solution, box, lengths, pushed, name, sign):
    data = integrate(make_solution(box, lambda c, *_: np.where(pushed(*c.T), 1.0, 0.0)), lengths)
    assert sign * total(data, name) > 0.05


def test_plate_load_is_pressure_difference_times_area_turned_into_wind_axes(make_solution, box, lengths):
    alpha, beta = 0.3, 0.2
    pressed = make_solution(box, lambda c, *_: np.where(c[:, 2] < -0.49, 0.5, 0.0), alpha=alpha, beta=beta)
    data = integrate(pressed, lengths)
    normal = 0.5 * 4.0 * 2.0 / 8.0
    assert total(data, "CN") == pytest.approx(normal)
    assert total(data, "CL") == pytest.approx(normal * np.cos(alpha))
    assert total(data, "CD") == pytest.approx(normal * np.sin(alpha) * np.cos(beta))
    assert total(data, "CY") == pytest.approx(normal * np.sin(alpha) * np.sin(beta))


def test_moments_move_with_the_centre(make_lengths, make_solution, box):
    flow = make_solution(box, smooth, alpha=0.25, beta=0.1)
    shift = np.array([0.7, -0.4, 0.3])
    here, there = (integrate(flow, make_lengths(moment_center=tuple(c))) for c in (np.zeros(3), shift))
    force = np.array([total(here, "CA"), 0.0, total(here, "CN")])
    axes_side = (total(here, "CY") - np.sin(0.1) * (force[0] * np.cos(0.25) + force[2] * np.sin(0.25))) / np.cos(0.1)
    force[1] = axes_side
    change = np.cross(-shift, force) * [-1.0, 1.0, -1.0] / [2.0, 4.0, 2.0]
    for name, expected in zip(("Cl", "Cm", "Cn"), change, strict=True):
        assert total(there, name) - total(here, name) == pytest.approx(expected, abs=1e-13)


def test_mirrored_wind_gives_mirrored_coefficients(make_solution, box, lengths):
    def pressure(center, mach, alpha, beta):
        return smooth(center * [1.0, np.sign(beta), 1.0], mach, alpha, abs(beta))

    data = integrate(make_solution(box, pressure, alpha=0.2, beta=[0.1, -0.1]), lengths)
    flipped = mirrored(data)
    for name in (*COEFFICIENTS, *PRESSURES):
        np.testing.assert_allclose(flipped[name].values[0], data[name].values[1], atol=1e-13)
    assert abs(total(data, "CY")) > 0.01
    assert flipped.CY.attrs == data.CY.attrs


def test_extrema_are_those_of_the_wall_by_part(make_solution, box, lengths):
    data = integrate(make_solution(box, lambda c, *_: c[:, 1]), lengths)
    assert total(data, "Cp_max") == pytest.approx(1.0)
    assert total(data, "Cp_min") == pytest.approx(-1.0)
    assert float(data.Cp_max.sel(part="wing_left")[0]) == pytest.approx(-0.75)


def test_a_failed_condition_has_no_numbers_and_an_oscillating_one_says_so(make_solution, box, lengths):
    flow = make_solution(box, smooth, alpha=[0.0, 0.1, 0.2], verdicts=["converged", "failed", "oscillating"])
    data = integrate(flow, lengths)
    for name in (*COEFFICIENTS, *PRESSURES, "CL_spread"):
        assert np.isnan(data[name].values[1]).all()
        assert np.isfinite(data[name].values[[0, 2]]).all()
    assert list(data.verdict.values) == ["converged", "failed", "oscillating"]


def test_spread_is_rescaled_from_wetted_to_reference_area(make_solution, box, lengths):
    data = integrate(make_solution(box, smooth, alpha=0.0, spread=0.01), lengths)
    assert wetted_area(box) == pytest.approx(2 * (4 * 2 + 4 * 1 + 2 * 1))
    assert float(data.CL_spread[0]) == pytest.approx(0.01 * 28.0 / 8.0)
    assert float(data.Cm_spread[0]) > 0.0


def test_a_force_that_wanders_turns_the_body_with_the_walls_arm(make_solution, box, make_lengths):
    """Seen from far ahead every piece of wall has one arm; about its middle a box of 4 by 2 by 1 m has 1.376 m."""
    for station, arm in ((-1000.0, 1000.0), (0.0, math.sqrt((4 * 2**2 + 24 * 4 / 3 + 16 / 4 + 12 / 12) / 28))):
        lengths = replace(make_lengths(), moment_center=(station, 0.0, 0.0))
        data = integrate(make_solution(box, smooth, alpha=0.0, spread=0.01), lengths)
        assert float(data.Cm_spread[0] / data.CN_spread[0]) * lengths.chord == pytest.approx(arm, rel=0.01)
    assert set(WITH_SPREAD) == {name.removesuffix("_spread") for name in data.data_vars if name.endswith("_spread")}


def test_the_spread_of_a_slow_oscillation_is_that_of_the_last_third(box, lengths, make_solution):
    flow = make_solution(box, smooth, alpha=[0.0, 0.0], verdicts=["converged", "oscillating"], spread=1e-4)
    history = np.zeros((60, 3))
    history[45:, 2] = 0.01
    records = tuple(replace(record, force_history=history) for record in flow.records)
    data = integrate(replace(flow, records=records), lengths)
    np.testing.assert_allclose(data.CN_spread, [1e-4 * 28.0 / 8.0, 0.005 * 28.0 / 8.0])


def test_every_value_states_units_axes_sign_and_reference(box_mesh, make_solution, lengths):
    data = integrate(make_solution(box_mesh(parts=("body",)), smooth), lengths)
    for name in data.data_vars:
        assert {"units", "axes", "positive", "reference", "long_name"} <= set(data[name].attrs), name
    assert data.attrs["reference_area_m2"] == 8.0
    assert list(data.part.values) == ["total", "body"]
