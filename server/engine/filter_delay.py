"""The delay that the joint filter adds, so that the latency shown to the operator is the one felt."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from teleop.config.body import FilterConfig
from teleop.joints import JOINT_NAMES

_UPPER = np.array([name.startswith(("shoulder_", "elbow", "wrist", "hand")) for name in JOINT_NAMES])


def filter_delay_s(velocity_m_s: npt.NDArray[np.float64], config: FilterConfig) -> float:
    """Group delay at low frequency of the fastest joint of the arms, the one the operator watches.

    A first-order low pass with cut-off f delays by 1 / (2 pi f); One-Euro's f is min_cutoff + beta * speed (Casiez,
    Roussel, Vogel 2012, eq. 5). velocity_m_s: (20, 3), the filter's own estimate. 0 when the filter is off.
    """
    if not config.enabled:
        return 0.0
    speed = np.nan_to_num(np.linalg.norm(velocity_m_s[_UPPER], axis=1))
    return float(1.0 / (2.0 * np.pi * (config.min_cutoff_hz + config.beta * speed.max())))
