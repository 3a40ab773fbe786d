"""Zones: the matrix, the borders, hysteresis and dwell."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from teleop.config.intent import ZoneConfig
from teleop.intent_types import Zone
from teleop.zones import ZoneState, step_zone, threshold_matrix, zone_at

CONFIG = ZoneConfig()
DT_S = 1 / 30


def test_threshold_matrix_is_cumulative_in_depth() -> None:
    depths, widths = threshold_matrix(CONFIG)
    assert depths == pytest.approx((1.4, 1.9, 2.8, 3.4))
    assert widths == pytest.approx((0.5, 0.8, 0.5, 0.0))


@pytest.mark.parametrize(
    ("x", "z", "zone"),
    [
        (0.0, 1.2, Zone.OUT),
        (0.0, 1.5, Zone.FORWARD),
        (0.0, 2.3, Zone.WORK),
        (0.39, 2.3, Zone.WORK),
        (0.0, 3.0, Zone.BACK),
        (0.0, 3.5, Zone.OUT),
        (-0.5, 1.5, Zone.LEFT),
        (-0.5, 3.3, Zone.LEFT),
        (0.5, 2.3, Zone.RIGHT),
        (0.95, 2.3, Zone.OUT),
        (-0.95, 2.3, Zone.OUT),
        (0.5, 1.3, Zone.OUT),
    ],
)
def test_zone_of_a_place(x: float, z: float, zone: Zone) -> None:
    assert zone_at(x, z, CONFIG) is zone


def walk(places: list[tuple[float, float]], state: ZoneState = ZoneState()) -> list[Zone]:
    zones = []
    for place in places:
        state = step_zone(state, place, DT_S, CONFIG)
        zones.append(state.zone)
    return zones


def test_entering_takes_the_dwell_and_no_longer() -> None:
    zones = walk([(0.0, 2.3)] * 30)
    entered = zones.index(Zone.WORK)
    assert CONFIG.dwell_s / DT_S <= entered <= CONFIG.dwell_s / DT_S + 1


def test_passing_through_a_zone_does_not_enter_it() -> None:
    zones = walk([(0.0, 2.3)] * 30 + [(0.0, 3.0)] * 3 + [(0.0, 2.3)] * 30)
    assert set(zones) == {Zone.NONE, Zone.WORK}


@pytest.mark.parametrize(
    "border",
    [(0.0, 1.4), (0.0, 1.9), (0.0, 2.8), (0.0, 3.4), (0.4, 2.3), (-0.4, 2.3), (0.9, 2.3), (0.4, 1.9), (0.4, 2.8)],
)
@pytest.mark.parametrize("rms_mm", [20.0, 20.0 * np.sqrt(3)])
def test_standing_on_a_border_for_a_minute_never_flips(border: tuple[float, float], rms_mm: float) -> None:
    rng = np.random.default_rng(7)
    noise = rng.normal(0.0, rms_mm * 1e-3 / np.sqrt(3), (1800, 2))
    zones = walk([(border[0] + dx, border[1] + dz) for dx, dz in noise])
    entered = [zone for zone in zones if zone is not Zone.NONE]
    assert len(set(entered)) == 1
    assert len(entered) > 1700


def test_a_clear_change_takes_less_than_a_fifth_of_a_second() -> None:
    rng = np.random.default_rng(3)
    delays = []
    for _ in range(200):
        noise = rng.normal(0.0, 0.0116, (60, 2))
        places = [(dx, (2.3 if i < 30 else 3.0) + dz) for i, (dx, dz) in enumerate(noise)]
        delays.append((walk(places).index(Zone.BACK) - 30) * DT_S)
    assert np.percentile(delays, 95) <= 0.2


def test_an_unknown_spine_keeps_the_zone() -> None:
    state = ZoneState(Zone.WORK)
    assert step_zone(state, None, DT_S, CONFIG) is state


@given(st.lists(st.tuples(st.floats(-2, 2), st.floats(0.3, 5)), max_size=80))
def test_a_zone_is_only_entered_near_its_rectangle(places: list[tuple[float, float]]) -> None:
    state = ZoneState()
    for place in places:
        before, state = state, step_zone(state, place, DT_S, CONFIG)
        if state.zone is not before.zone:
            wide = [
                zone_at(place[0] + dx, place[1] + dz, CONFIG)
                for dx in (-CONFIG.margin_m, 0, CONFIG.margin_m)
                for dz in (-CONFIG.margin_m, 0, CONFIG.margin_m)
            ]
            assert state.zone in wide


def test_a_margin_wider_than_the_zones_is_refused() -> None:
    with pytest.raises(ValidationError, match="margin_m must be below half the narrowest zone"):
        ZoneConfig(margin_m=0.2, l2_m=0.3)
