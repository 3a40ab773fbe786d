"""Whether the operator walks: legs tell a task only while their owner stands."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, hypot


@dataclass(frozen=True, slots=True)
class Gait:
    """Low-passed place of the spine on the floor [m]; its speeds to the side and to or from the sensor [m/s]."""

    xz_m: tuple[float, float] | None = None
    side_m_s: float = 0.0
    ahead_m_s: float = 0.0

    @property
    def speed_m_s(self) -> float:
        """Speed over the floor."""
        return hypot(self.side_m_s, self.ahead_m_s)


def step_gait(gait: Gait, spine_xz_m: tuple[float, float] | None, dt_s: float, smoothing_s: float) -> Gait:
    """One frame; an unknown spine begins anew. smoothing_s: time constant of the low-pass the speed is taken from."""
    if spine_xz_m is None:
        return Gait()
    if gait.xz_m is None:
        return Gait(spine_xz_m)
    dx, dz = spine_xz_m[0] - gait.xz_m[0], spine_xz_m[1] - gait.xz_m[1]
    # a ramp lags behind its low-pass by speed times time constant
    share = 1.0 - exp(-dt_s / smoothing_s)
    place = (gait.xz_m[0] + share * dx, gait.xz_m[1] + share * dz)
    return Gait(place, abs(spine_xz_m[0] - place[0]) / smoothing_s, abs(spine_xz_m[1] - place[1]) / smoothing_s)
