"""What every trajectory is: joint values, speeds and accelerations as functions of time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Samples: t_s (M,), q (M, n) rad, qd rad/s, qdd rad/s^2 (m for sliding joints)."""

    t_s: FloatArray
    q: FloatArray
    qd: FloatArray
    qdd: FloatArray


class Trajectory(ABC):
    """A motion from time 0 to duration_s; outside that it rests at its ends."""

    @property
    @abstractmethod
    def duration_s(self) -> float:
        """Length in s."""

    @abstractmethod
    def _evaluate(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """q, qd, qdd, each (M, n), for times (M,) inside [0, duration]."""

    def at(self, t_s: npt.ArrayLike) -> Motion:
        """Samples at the given times (M,) or one time; before 0 and after the end the arm stands still."""
        t = np.atleast_1d(np.asarray(t_s, dtype=np.float64))
        q, qd, qdd = self._evaluate(np.clip(t, 0.0, self.duration_s))
        outside = ((t < 0) | (t > self.duration_s))[:, None]
        return Motion(t, q, np.where(outside, 0.0, qd), np.where(outside, 0.0, qdd))

    def sample(self, step_s: float) -> Motion:
        """Samples every step_s from 0 to the end, the end itself included."""
        if not step_s > 0:
            raise RobotError(f"a time step must be positive, got {step_s} s")
        count = int(np.floor(self.duration_s / step_s + 1e-9))
        t = np.arange(count + 1) * step_s
        if self.duration_s - t[-1] > 1e-9 * max(1.0, self.duration_s):
            t = np.append(t, self.duration_s)
        return self.at(np.minimum(t, self.duration_s))


@dataclass(frozen=True, eq=False)
class Sequence(Trajectory):
    """Trajectories one after the other, with a pause after each."""

    parts: tuple[Trajectory, ...]
    pause_s: float = 0.0

    def __post_init__(self) -> None:
        if not self.parts:
            raise RobotError("a sequence needs at least one trajectory")

    @property
    def starts_s(self) -> FloatArray:
        """When each part begins (K,)."""
        return np.concatenate([[0.0], np.cumsum([p.duration_s + self.pause_s for p in self.parts])[:-1]])

    @property
    def duration_s(self) -> float:
        return float(sum(p.duration_s for p in self.parts) + self.pause_s * (len(self.parts) - 1))

    def _evaluate(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        starts = self.starts_s
        which = np.clip(np.searchsorted(starts, t_s, side="right") - 1, 0, len(self.parts) - 1)
        n = self.parts[0].at(0.0).q.shape[1]
        out = np.empty((3, len(t_s), n))
        for k in np.unique(which):
            here = which == k
            m = self.parts[k].at(t_s[here] - starts[k])
            out[0, here], out[1, here], out[2, here] = m.q, m.qd, m.qdd
        return out[0], out[1], out[2]


def check_ends(q0: npt.ArrayLike, qf: npt.ArrayLike, duration_s: float) -> tuple[FloatArray, FloatArray]:
    """Both ends as (n,) float64. RobotError for unlike lengths, values not finite, a bad duration."""
    a, b = (np.atleast_1d(np.asarray(q, dtype=np.float64)) for q in (q0, qf))
    if a.shape != b.shape or a.ndim != 1 or not (np.isfinite(a).all() and np.isfinite(b).all()):
        raise RobotError(f"start and end must be finite and of one length, got shapes {a.shape} and {b.shape}")
    if not (np.isfinite(duration_s) and duration_s > 0):
        raise RobotError(f"a duration must be positive, got {duration_s} s")
    return a, b
