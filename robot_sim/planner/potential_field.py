"""Artificial potential field with detection of and escape from local minima.

Attraction: conic far away, quadratic near. Repulsion: Khatib 1986, 0.5 eta (1/d - 1/d0)^2 within d0, multiplied by the
squared distance to the goal (Ge and Cui 2000), so that a goal close to an obstacle stays a minimum: the picking point
lies just above the bunch. Where the descent no longer gains on the goal, a way out is searched and the minimum is
remembered as one more repelling ball.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt
from pydantic import Field

from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.planner.scene import Scene
from robot_sim.section import RobotSection


class FieldConfig(RobotSection):
    """Numbers of the field."""

    step_m: float = Field(default=0.01, gt=0, le=0.1, description="length of one step [m]; choice")
    reach_m: float = Field(default=0.12, gt=0, le=1, description="repulsion acts within d0 of a surface [m]; choice")
    eta: float = Field(default=0.0006, gt=0, le=10, description="weight of repulsion [1]; choice")
    near_m: float = Field(default=0.05, gt=0, le=1, description="attraction is quadratic within this [m]; choice")
    margin_m: float = Field(default=0.004, ge=0, le=0.1, description="a path keeps at least this clearance [m]; choice")
    window: int = Field(default=12, ge=3, le=200, description="steps over which progress is judged [1]; choice")
    progress: float = Field(
        default=0.25, gt=0, lt=1, description="a minimum: gain on the goal below this share of the steps [1]; choice"
    )
    escapes: int = Field(default=12, ge=0, le=100, description="local minima left before giving up [1]; choice")
    hops: int = Field(default=400, ge=1, le=10_000, description="points tried to leave one minimum [1]; choice")
    steps: int = Field(default=900, ge=10, le=100_000, description="steps before giving up [1]; choice")


class PathReason(StrEnum):
    """Why there is, or is no, path."""

    FOUND = "path.found"
    START_BLOCKED = "path.start_blocked"
    GOAL_BLOCKED = "path.goal_blocked"
    LOCAL_MINIMUM = "path.local_minimum"
    TOO_LONG = "path.too_long"


@dataclass(frozen=True, slots=True, eq=False)
class PathResult:
    """points (M, 3) from start to goal, empty without a path; minima: local minima met; clearance over the path, m."""

    points: FloatArray
    reason: PathReason
    minima: int
    clearance_m: float

    @property
    def ok(self) -> bool:
        """Whether there is a path."""
        return self.reason is PathReason.FOUND


@dataclass(frozen=True, slots=True, eq=False)
class _Body:
    offsets: FloatArray
    radii: FloatArray


def _force(
    p: FloatArray, goal: FloatArray, scene: Scene, body: _Body, memory: list[FloatArray], c: FieldConfig
) -> FloatArray:
    """Negative gradient of the potential at p (3,)."""
    away = goal - p
    distance = float(np.linalg.norm(away))
    pull = away / max(distance, c.near_m)
    push = np.zeros(3)
    if scene.solids:
        d, n = scene.nearest(p + body.offsets)
        d = np.maximum(d - body.radii, 1e-3)
        acts = d < c.reach_m
        if acts.any():
            inverse = 1 / d[acts] - 1 / c.reach_m
            # Ge and Cui with n = 2: one part along the normal, one towards the goal; both fade at the goal
            rep = c.eta * inverse / d[acts] ** 2 * distance**2
            extra = c.eta * inverse**2 * distance
            # every solid counts once, by its strongest control point, so that many spheres do not add up
            strongest = np.zeros(acts.shape)
            strongest[acts] = rep
            best = strongest.argmax(axis=1)
            rows = np.nonzero(strongest.max(axis=1) > 0)[0]
            push += (strongest[rows, best[rows], None] * n[rows, best[rows]]).sum(axis=0)
            push += float(extra.max(initial=0.0)) * away / max(distance, 1e-9)
    for m in memory:
        v = p - m
        r = float(np.linalg.norm(v))
        if r < 1.5 * c.reach_m:
            push += 0.8 * (1 - r / (1.5 * c.reach_m)) * v / max(r, 1e-9)
    return np.asarray(pull + push)


def _segment_free(a: FloatArray, b: FloatArray, scene: Scene, body: _Body, c: FieldConfig) -> bool:
    count = max(2, int(np.ceil(np.linalg.norm(b - a) / c.step_m)) + 1)
    line = a + np.linspace(0, 1, count)[:, None] * (b - a)
    return bool(scene.clearance(line, body.offsets, body.radii).min() >= c.margin_m)


def _directions(count: int) -> FloatArray:
    """Directions (count, 3) spread evenly over the sphere (Fibonacci)."""
    i = np.arange(count)
    z = 1 - (2 * i + 1) / count
    turn = np.pi * (1 + np.sqrt(5)) * i
    rim = np.sqrt(1 - z**2)
    return np.stack([rim * np.cos(turn), rim * np.sin(turn), z], axis=1)


def _detour(trap: FloatArray, goal: FloatArray, scene: Scene, body: _Body, c: FieldConfig) -> list[FloatArray]:
    """Corners of a way out of a trap: best-first over free straight hops, until a point sees the goal or is nearer to
    it than the trap by more than the repulsion's reach. Empty when the search ends without one."""
    hops = np.concatenate([r * _directions(32) for r in (0.1, 0.25)])
    far = float(np.linalg.norm(goal - trap))
    queue: list[tuple[float, int]] = [(far, 0)]
    nodes, parents, costs = [trap], [-1], [0.0]
    seen = {tuple(np.round(trap / 0.08).astype(int))}
    for _ in range(c.hops):
        if not queue:
            return []
        _, k = heapq.heappop(queue)
        p = nodes[k]
        gap = float(np.linalg.norm(goal - p))
        if k and (gap < far - c.reach_m or _segment_free(p, goal, scene, body, c)):
            way = []
            while k > 0:
                way.append(nodes[k])
                k = parents[k]
            return way[::-1]
        ends = p + hops
        open_ends = scene.clearance(ends, body.offsets, body.radii) >= c.margin_m
        for q in ends[open_ends]:
            cell = tuple(np.round(q / 0.08).astype(int))
            if cell in seen or not _segment_free(p, q, scene, body, c):
                continue
            seen.add(cell)
            nodes.append(q)
            parents.append(k)
            costs.append(costs[k] + float(np.linalg.norm(q - p)))
            heapq.heappush(queue, (costs[-1] + float(np.linalg.norm(goal - q)), len(nodes) - 1))
    return []


def _descend(
    start: FloatArray, goal: FloatArray, scene: Scene, body: _Body, memory: list[FloatArray], c: FieldConfig
) -> tuple[list[FloatArray], bool]:
    """Steps from start towards goal; True when it arrived, False at a local minimum or when the steps ran out."""
    path = [start]
    gaps = [float(np.linalg.norm(goal - start))]
    for _ in range(c.steps):
        p = path[-1]
        if gaps[-1] <= 1.5 * c.step_m and _segment_free(p, goal, scene, body, c):
            path.append(goal)
            return path, True
        force = _force(p, goal, scene, body, memory, c)
        size = float(np.linalg.norm(force))
        if size < 1e-9:
            return path, False
        step = p + min(c.step_m, gaps[-1]) * force / size
        if scene.clearance(step[None], body.offsets, body.radii)[0] < c.margin_m:
            # the step would enter the margin: slide along the surface instead
            d, n = scene.nearest(p + body.offsets)
            k, j = np.unravel_index(int(np.argmin(d - body.radii)), d.shape)
            normal = n[k, j]
            slide = force - min(0.0, float(force @ normal)) * normal
            if np.linalg.norm(slide) < 1e-6:
                return path, False
            step = p + c.step_m * slide / np.linalg.norm(slide)
            if scene.clearance(step[None], body.offsets, body.radii)[0] < c.margin_m:
                return path, False
        path.append(step)
        gaps.append(float(np.linalg.norm(goal - step)))
        slow = len(gaps) > c.window and gaps[-c.window - 1] - min(gaps[-c.window :]) < c.progress * c.window * c.step_m
        # slow near the goal is arriving, not a trap
        if slow and gaps[-1] > 2 * c.step_m and not _gaining(path, c):
            return path, False
    return path, False


def _gaining(path: list[FloatArray], c: FieldConfig) -> bool:
    """Whether the last steps lead somewhere (along an obstacle) and do not circle or tremble on the spot."""
    travelled = float(np.linalg.norm(path[-1] - path[-c.window]))
    return travelled > 0.6 * c.window * c.step_m and len(path) < 8 * c.window


def plan_path(
    start_m: npt.ArrayLike,
    goal_m: npt.ArrayLike,
    scene: Scene,
    offsets_m: npt.ArrayLike = ((0.0, 0.0, 0.0),),
    radii_m: npt.ArrayLike = (0.0,),
    config: FieldConfig | None = None,
) -> PathResult:
    """Path of a body of control spheres (offsets (C, 3), radii (C,)) from start (3,) to goal (3,), world axes, m.

    The path returned keeps the configured clearance at every point and between them.
    """
    c = config or FieldConfig()
    start, goal = np.asarray(start_m, dtype=np.float64), np.asarray(goal_m, dtype=np.float64)
    body = _Body(
        np.atleast_2d(np.asarray(offsets_m, dtype=np.float64)), np.atleast_1d(np.asarray(radii_m, dtype=np.float64))
    )
    if start.shape != (3,) or goal.shape != (3,) or body.offsets.shape != (len(body.radii), 3):
        raise RobotError("a path needs start (3,), goal (3,) and as many radii as offsets (C, 3)")
    none = np.empty((0, 3))
    ends = scene.clearance(np.stack([start, goal]), body.offsets, body.radii)
    if ends[0] < c.margin_m:
        return PathResult(none, PathReason.START_BLOCKED, 0, float(ends[0]))
    if ends[1] < c.margin_m:
        return PathResult(none, PathReason.GOAL_BLOCKED, 0, float(ends[1]))
    path: list[FloatArray] = [start]
    memory: list[FloatArray] = []
    for _ in range(c.escapes + 1):
        part, arrived = _descend(path[-1], goal, scene, body, memory, c)
        path += part[1:]
        if arrived:
            points = np.array(path)
            return PathResult(
                points, PathReason.FOUND, len(memory), float(scene.clearance(points, body.offsets, body.radii).min())
            )
        if len(path) > c.steps:
            return PathResult(none, PathReason.TOO_LONG, len(memory), float("nan"))
        memory.append(path[-1])
        corners = _detour(path[-1], goal, scene, body, c)
        if not corners:
            break
        for corner in corners:
            base = path[-1]
            count = max(1, int(np.ceil(np.linalg.norm(corner - base) / c.step_m)))
            path += [base + s * (corner - base) for s in np.linspace(0, 1, count + 1)[1:]]
    return PathResult(none, PathReason.LOCAL_MINIMUM, len(memory), float("nan"))
