"""Where the last two frames let expect an operator's joints in the next one: they go on as they went."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
GOES_ON: Final = 0.8
"""Share of a velocity that is expected to go on: a part of it is noise, and arms slow down again; measured."""


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """joints_m: (20, 3) as the networks placed them in the last frame. velocity_m_s: (20, 3) since the one before, zero
    where there was none."""

    joints_m: Floats
    velocity_m_s: Floats


def follow(before: Course | None, joints_m: Floats, dt_s: float) -> Course:
    """The course after one more frame, ``dt_s`` later."""
    if before is None:
        return Course(joints_m, np.zeros_like(joints_m))
    return Course(joints_m, (joints_m - before.joints_m) / dt_s)


def expect(course: Course | None, dt_s: float) -> Floats | None:
    """Joints (20, 3) ``dt_s`` later; None where nothing is known."""
    return None if course is None else course.joints_m + GOES_ON * dt_s * course.velocity_m_s
