"""Elbows as bent as they are: what noise and caution of the networks do to the angle on the mean is taken back.

Noise across a straight arm can only bend it: the bend that is found is Rician, its square too large by twice the
variance (Gudbjartsson and Patz 1995). A forearm that is hard to see is drawn towards the middle of what training saw,
the more the less sure it is; so a bent arm is found too straight. Only the elbow moves, across the line from shoulder
to wrist, which are found better.
"""

from __future__ import annotations

from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.config.body import ElbowConfig
from teleop.joints import JOINT_INDEX

Floats = npt.NDArray[np.float64]
_ARMS: Final = np.array(
    [[JOINT_INDEX[f"{name}_{side}"] for name in ("shoulder", "elbow", "wrist")] for side in ("right", "left")]
)
_FOLDED_RAD: Final = float(np.radians(110.0))
_FADES_RAD: Final = float(np.radians(20.0))
"""From 90 degrees of bend on a forearm's caution is taken back less, from 110 on not at all."""
_MOST_M: Final = 0.03
"""An elbow is never moved further outward."""


@nb.njit(cache=True, nogil=True)
def _way_to(
    elbow: Floats, shoulder: Floats, wrist: Floats, spread_m: Floats, limits: tuple[float, float, float, float, float]
) -> tuple[float, float, float]:
    """Where the elbow belongs from where it is [m]; zero where it stays. spread_m: (3,) of shoulder, elbow, wrist.
    limits: noise, angle taken for straight, caution, middle, largest spread; angles in rad."""
    noise, straight_rad, caution, middle_rad, most_rad = limits
    long_m, along_m, off_m = 0.0, 0.0, 0.0
    for k in range(3):
        long_m += (wrist[k] - shoulder[k]) ** 2
    long_m = np.sqrt(long_m)
    if not long_m > 1e-3:  # also where one of them is unknown
        return 0.0, 0.0, 0.0
    across = np.empty(3)
    for k in range(3):
        along_m += (elbow[k] - shoulder[k]) * (wrist[k] - shoulder[k]) / long_m
    for k in range(3):
        across[k] = elbow[k] - shoulder[k] - along_m / long_m * (wrist[k] - shoulder[k])
        off_m += across[k] ** 2
    off_m = np.sqrt(off_m)
    if not off_m > 1e-6:
        return 0.0, 0.0, 0.0
    upper_m, fore_m = np.hypot(along_m, off_m), np.hypot(long_m - along_m, off_m)
    bend_rad = np.arctan2(off_m, along_m) + np.arctan2(off_m, long_m - along_m)
    # the three joints' errors, as they move the elbow against the line
    share = fore_m / (upper_m + fore_m)
    noise_m = np.sqrt(spread_m[1] ** 2 + (share * spread_m[0]) ** 2 + ((1.0 - share) * spread_m[2]) ** 2)
    variance = min(noise_m * (1.0 / upper_m + 1.0 / fore_m), most_rad) ** 2
    straight = np.exp(-((bend_rad / straight_rad) ** 2))
    meant_rad = np.sqrt(max(bend_rad**2 - noise * straight * variance, 0.0))
    # folded arms are as they are found: nothing was fitted there, and crossed forearms stop the robot
    folded = min(max((_FOLDED_RAD - bend_rad) / _FADES_RAD, 0.0), 1.0)
    meant_rad += folded * caution * variance * max(bend_rad - middle_rad, 0.0)
    # radians of bend that a metre across the line makes
    per_m = max(along_m / upper_m**2 + (long_m - along_m) / fore_m**2, 1.0)
    step = min(max((meant_rad - bend_rad) / per_m, -off_m), _MOST_M) / off_m
    return step * across[0], step * across[1], step * across[2]


def unbend(joints_m: Floats, spread_m: Floats, config: ElbowConfig) -> Floats:
    """The joints (20, 3) with both elbows moved; those of unknown joints stay. spread_m: (20,), of the networks."""
    if not config.enabled:
        return joints_m
    out = joints_m.copy()
    straight_rad, middle_rad, most_rad = np.radians((config.straight_deg, config.middle_deg, config.most_spread_deg))
    limits = (config.noise, straight_rad, config.caution, middle_rad, most_rad)
    for arm in _ARMS:
        shoulder, elbow, wrist = joints_m[arm]
        out[arm[1]] += _way_to(elbow, shoulder, wrist, spread_m[arm], limits)
    return out
