"""The carried bunch on its way: how far it presses into its neighbour, how near it comes to cane and post.

The bunch hangs from the fingers as it hung when they closed; the tool stays level, so it stays upright.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.distance import cdist

from robot_sim.kinematics.transforms import FloatArray, inverse_pose
from robot_sim.planner.shapes import Cylinder, Solid
from robot_sim.studies.grape_scene import Bunch, GrapeScene


def carried_hit(scene: GrapeScene, index: int, poses: FloatArray, press_m: float) -> str:
    """What the true bunch runs into along tool poses (M, 4, 4), the first being the picking pose; '' for nothing.

    Berries of a touching pair already overlap where they hang; they may press press_m deeper, which berries yield.
    """
    bunch = scene.bunches[index]
    from_pick = poses @ inverse_pose(poses[0])
    others = [b for i, b in enumerate(scene.bunches) if i != index]
    hanging = [min(0.0, _gap(bunch.berries_m, bunch, other)) for other in others]
    for T in from_pick:
        berries = bunch.berries_m @ T[:3, :3].T + T[:3, 3]
        for other, before in zip(others, hanging, strict=True):
            if _gap(berries, bunch, other) < before - press_m:
                return "carry: the bunch is pressed into its neighbour"
        for name, solid in _obstacles(scene):
            if (solid.distance(berries)[0] - bunch.radii_m).min() < 0:
                return f"carry: the bunch meets the {name}"
    return ""


def carried_volume_hit(seen: GrapeScene, index: int, poses: FloatArray, press_m: float) -> str:
    """The same as the planner sees it: upright cylinders instead of berries."""
    volume = seen.bunches[index].volume
    others = [b.volume for i, b in enumerate(seen.bunches) if i != index]
    from_pick = poses @ inverse_pose(poses[0])
    centres = volume.centre @ np.swapaxes(from_pick[:, :3, :3], 1, 2) + from_pick[:, :3, 3]
    for other in others:
        apart = np.hypot(*(centres - other.centre)[:, :2].T) - volume.radius_m - other.radius_m
        level = np.abs(centres[:, 2] - other.centre[2]) < 0.5 * (volume.height_m + other.height_m)
        if (level & (apart < min(0.0, apart[0]) - press_m)).any():
            return "carry: the bunch would be pressed into its neighbour"
    surface = _surface(volume)
    for name, solid in _obstacles(seen):
        points = (centres[:, None, :] + surface).reshape(-1, 3)
        if solid.distance(points)[0].min() < 0:
            return f"carry: the bunch would meet the {name}"
    return ""


def _gap(berries_m: FloatArray, bunch: Bunch, other: Bunch) -> float:
    apart = cdist(berries_m, other.berries_m) - bunch.radii_m[:, None] - other.radii_m
    return float(apart.min())


def _obstacles(scene: GrapeScene) -> list[tuple[str, Solid]]:
    return [("cane", scene.cane)] if scene.post is None else [("cane", scene.cane), ("post", scene.post)]


def _surface(volume: Cylinder) -> FloatArray:
    """Points (N, 3) of the side and the rims about the volume's centre."""
    a, h = np.meshgrid(np.linspace(0, 2 * np.pi, 12, endpoint=False), np.linspace(-0.5, 0.5, 5))
    r = volume.radius_m
    return np.stack([r * np.cos(a), r * np.sin(a), h * volume.height_m], axis=-1).reshape(-1, 3)
