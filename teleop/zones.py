"""Where the operator stands: the 2x4 threshold matrix, with hysteresis and dwell (source eq. 4-7)."""

from __future__ import annotations

from dataclasses import dataclass

from teleop.config.intent import ZoneConfig
from teleop.intent_types import Zone

Matrix = tuple[tuple[float, float, float, float], tuple[float, float, float, float]]
Rectangle = tuple[float, float, float, float]
"""x from, x to, z from, z to, in metres."""


def threshold_matrix(config: ZoneConfig) -> Matrix:
    """T (5): row one the cumulative depths, row two the widths, in metres."""
    l1, l2, l3, l4 = config.l1_m, config.l2_m, config.l3_m, config.l4_m
    return (
        (l1, l1 + l2, l1 + l2 + l3, l1 + l2 + l3 + l4),
        (config.l5_m, config.l6_m, config.l7_m, config.l8_m),
    )


def rectangles(config: ZoneConfig) -> dict[Zone, Rectangle]:
    """Every zone as a rectangle on the floor; outside all of them is OUT."""
    (z1, z2, z3, z4), (left, centre, right, _) = threshold_matrix(config)
    half = centre / 2
    return {
        Zone.FORWARD: (-half, half, z1, z2),  # (6)
        Zone.WORK: (-half, half, z2, z3),  # (7)
        Zone.BACK: (-half, half, z3, z4),
        Zone.LEFT: (-half - left, -half, z1, z4),
        Zone.RIGHT: (half, half + right, z1, z4),
    }


def zone_at(x_m: float, z_m: float, config: ZoneConfig) -> Zone:
    """The zone of a = [x, z] (4), without any memory."""
    for zone, (x0, x1, z0, z1) in rectangles(config).items():
        if x0 <= x_m < x1 and z0 <= z_m < z1:
            return zone
    return Zone.OUT


def within(zone: Zone, x_m: float, z_m: float, margin_m: float, config: ZoneConfig) -> bool:
    """Whether a point still counts as in a zone widened by a margin (OUT: all zones narrowed by it)."""
    zones = rectangles(config)
    if zone is Zone.OUT:
        x0, x1, z0, z1 = zones[Zone.LEFT][0], zones[Zone.RIGHT][1], zones[Zone.LEFT][2], zones[Zone.LEFT][3]
        return not (x0 + margin_m <= x_m < x1 - margin_m and z0 + margin_m <= z_m < z1 - margin_m)
    if zone is Zone.NONE:
        return False
    x0, x1, z0, z1 = zones[zone]
    return x0 - margin_m <= x_m < x1 + margin_m and z0 - margin_m <= z_m < z1 + margin_m


@dataclass(frozen=True, slots=True)
class ZoneState:
    """The zone that counts, and the one that may follow it, with the time it has been seen."""

    zone: Zone = Zone.NONE
    candidate: Zone = Zone.NONE
    candidate_s: float = 0.0

    @property
    def settled(self) -> bool:
        """Whether the last sample lay in the zone that counts."""
        return self.candidate is Zone.NONE


def step_zone(state: ZoneState, spine_xz_m: tuple[float, float] | None, dt_s: float, config: ZoneConfig) -> ZoneState:
    """One frame. The occupant of a zone leaves it by the margin, and enters the next after the dwell.

    Out of all zones the robot stops, and a stop waits less long than a start.
    An unknown spine keeps the zone: whoever asks decides for how long.
    """
    if spine_xz_m is None:
        return state
    x, z = spine_xz_m
    if within(state.zone, x, z, config.margin_m, config):
        return ZoneState(state.zone)
    if state.candidate is not Zone.NONE and within(state.candidate, x, z, config.margin_m, config):
        candidate: Zone = state.candidate
        seen_s = state.candidate_s + dt_s
    else:
        candidate, seen_s = zone_at(x, z, config), 0.0
    if seen_s >= (config.out_dwell_s if candidate is Zone.OUT else config.dwell_s):
        return ZoneState(candidate)
    return ZoneState(state.zone, candidate, seen_s)
