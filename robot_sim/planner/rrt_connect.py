"""RRT-Connect (Kuffner and LaValle 2000) in joint space: the well-known planner to compare the potential field with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robot_sim.kinematics.transforms import FloatArray

IsFree = Callable[[FloatArray], bool]


@dataclass(frozen=True, slots=True, eq=False)
class RrtResult:
    """path (M, n) from start to goal in steps, empty when none was found; checks: configurations tested."""

    path: FloatArray
    checks: int

    @property
    def ok(self) -> bool:
        """Whether there is a path."""
        return len(self.path) > 0


class _Tree:
    def __init__(self, root: FloatArray) -> None:
        self.nodes = [root]
        self.parents = [-1]

    def nearest(self, q: FloatArray) -> int:
        return int(np.argmin(((np.array(self.nodes) - q) ** 2).sum(axis=1)))

    def add(self, q: FloatArray, parent: int) -> int:
        self.nodes.append(q)
        self.parents.append(parent)
        return len(self.nodes) - 1

    def way(self, k: int) -> list[FloatArray]:
        out = []
        while k >= 0:
            out.append(self.nodes[k])
            k = self.parents[k]
        return out[::-1]


def rrt_connect(
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    lower: FloatArray,
    upper: FloatArray,
    is_free: IsFree,
    rng: np.random.Generator,
    *,
    step_rad: float = 0.08,
    iterations: int = 2000,
    smoothing: int = 60,
) -> RrtResult:
    """Joint path from start (n,) to goal (n,); is_free says whether a configuration collides. Shortcuts smooth it."""
    a, b = np.asarray(start, dtype=np.float64), np.asarray(goal, dtype=np.float64)
    checks = 0

    def free(q: FloatArray) -> bool:
        nonlocal checks
        checks += 1
        return is_free(q)

    def extend(tree: _Tree, target: FloatArray) -> tuple[int, bool]:
        """Grow towards the target until it is met or something is in the way."""
        k = tree.nearest(target)
        while True:
            gap = target - tree.nodes[k]
            size = float(np.abs(gap).max())
            if size < 1e-9:
                return k, True
            q = target if size <= step_rad else tree.nodes[k] + gap * (step_rad / size)
            if not free(q):
                return k, False
            k = tree.add(q, k)

    def connect() -> list[FloatArray] | None:
        near, far = _Tree(a), _Tree(b)
        forward = True
        for _ in range(iterations):
            k, _ = extend(near, rng.uniform(lower, upper))
            j, met = extend(far, near.nodes[k])
            if met:
                first, second = near.way(k), far.way(j)
                return first + second[::-1][1:] if forward else second + first[::-1][1:]
            near, far, forward = far, near, not forward
        return None

    if not (free(a) and free(b)):
        return RrtResult(np.empty((0, len(a))), checks)
    path = connect()
    if path is None:
        return RrtResult(np.empty((0, len(a))), checks)
    for _ in range(smoothing):
        if len(path) < 3:
            break
        i, j = sorted(rng.choice(len(path), 2, replace=False))
        count = int(np.ceil(np.abs(path[j] - path[i]).max() / step_rad))
        if j - i < 2 or count >= j - i + 1:
            continue
        line = [path[i] + s * (path[j] - path[i]) for s in np.linspace(0, 1, count + 1)]
        if all(free(q) for q in line[1:-1]):
            path[i : j + 1] = line
    return RrtResult(np.array(path), checks)
