"""Elbows as bent as they are: what noise and caution of the networks do to the angle on the mean is taken back.

Noise across a straight arm can only bend it: the bend that is found is Rician, its square too large by twice the
variance (Gudbjartsson and Patz 1995). A forearm that is hard to see is drawn towards the middle of what training saw,
the more the less sure it is; so a bent arm is found too straight. Only the elbow moves, across the line from shoulder
to wrist, which are found better.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.config.body import ElbowConfig
from teleop.joints import JOINT_INDEX

Floats = npt.NDArray[np.float64]
_ARMS: Final = tuple(
    tuple(JOINT_INDEX[f"{name}_{side}"] for name in ("shoulder", "elbow", "wrist")) for side in ("right", "left")
)
_FOLDED_RAD: Final = float(np.radians(110.0))
_FADES_RAD: Final = float(np.radians(20.0))
"""From 90 degrees of bend on a forearm's caution is taken back less, from 110 on not at all."""
_MOST_M: Final = 0.03
"""An elbow is never moved further outward."""


def unbend(joints_m: Floats, spread_m: Floats, config: ElbowConfig) -> Floats:
    """The joints (20, 3) with both elbows moved; those of unknown joints stay. spread_m: (20,), of the networks."""
    if not config.enabled:
        return joints_m
    out = joints_m.copy()
    for shoulder, elbow, wrist in _ARMS:
        out[elbow] = _moved(joints_m[shoulder], joints_m[elbow], joints_m[wrist], spread_m[[shoulder, elbow, wrist]],
                            config)  # fmt: skip
    return out


def _moved(shoulder_m: Floats, elbow_m: Floats, wrist_m: Floats, spread_m: Floats, config: ElbowConfig) -> Floats:
    way = wrist_m - shoulder_m
    long_m = float(np.linalg.norm(way))
    if not long_m > 1e-3:  # also where one of them is unknown
        return elbow_m
    along_m = float((elbow_m - shoulder_m) @ way) / long_m
    across = elbow_m - shoulder_m - (along_m / long_m) * way
    off_m = float(np.linalg.norm(across))
    if not off_m > 1e-6:
        return elbow_m
    upper_m, fore_m = np.hypot(along_m, off_m), np.hypot(long_m - along_m, off_m)
    bend_rad = np.arctan2(off_m, along_m) + np.arctan2(off_m, long_m - along_m)
    # the three joints' errors, as they move the elbow against the line
    share = fore_m / (upper_m + fore_m)
    noise_m = np.sqrt(spread_m[1] ** 2 + (share * spread_m[0]) ** 2 + ((1.0 - share) * spread_m[2]) ** 2)
    variance = min(noise_m * (1.0 / upper_m + 1.0 / fore_m), np.radians(config.most_spread_deg)) ** 2
    straight = np.exp(-((bend_rad / np.radians(config.straight_deg)) ** 2))
    meant_rad = np.sqrt(max(bend_rad**2 - config.noise * straight * variance, 0.0))
    # folded arms are as they are found: nothing was fitted there, and crossed forearms stop the robot
    folded = min(max((_FOLDED_RAD - bend_rad) / _FADES_RAD, 0.0), 1.0)
    meant_rad += folded * config.caution * variance * max(bend_rad - np.radians(config.middle_deg), 0.0)
    # radians of bend that a metre across the line makes
    per_m = max(along_m / upper_m**2 + (long_m - along_m) / fore_m**2, 1.0)
    step_m = min(max((meant_rad - bend_rad) / per_m, -off_m), _MOST_M)
    return np.asarray(elbow_m + (step_m / off_m) * across)
