"""PyBullet's own view of a pick: ready, clamped, carried, over the basket."""

from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np

from robot_sim.arms.rb03 import tool_values
from robot_sim.collision import CollisionWorld
from robot_sim.studies.grape_plan import PickPlan
from robot_sim.studies.grape_scene import GrapeScene
from robot_sim.studies.grape_trial import PickWorld

COLORS = {
    "bunch": (0.40, 0.18, 0.50, 1.0),
    "stem": (0.45, 0.60, 0.25, 1.0),
    "cane": (0.45, 0.30, 0.15, 1.0),
    "post": (0.60, 0.55, 0.50, 1.0),
}


def save_pictures(
    folder: Path, urdf: str, at: PickWorld, scene: GrapeScene, plan: PickPlan, tray_deg: float
) -> list[str]:
    """Write the pictures; returns their file names."""
    a, grip = plan.approach, 2 * at.study.stem_radius_m
    tray = math.radians(tray_deg)
    moments = (
        ("ready", plan.out_q[-1], a.tool()),
        ("clamped", plan.pick_q[-1], tool_values(grip, 0.0, a.blade_rad)),
        ("carried", plan.pick_q[-1], tool_values(grip, tray, 0.0)),
        ("basket", plan.basket_q[-1], tool_values(grip, tray, 0.0)),
    )
    target = scene.bunches[a.bunch].top_m - np.array([0.12 * math.cos(a.yaw_rad), 0.12 * math.sin(a.yaw_rad), 0.05])
    # look from the side where no post is in the way
    left = scene.post is None or math.atan2(scene.post.centre[1], scene.post.centre[0]) < a.yaw_rad
    side = a.yaw_rad + math.radians(75 if left else -75)
    eye = target + 0.85 * np.array([math.cos(side), math.sin(side), 0.45])
    written = []
    with CollisionWorld(urdf, drawn=True) as world:
        view = PickWorld(world, at.arm, at.arm_config, at.study, at.path_field, at.q_start)
        view.add_true(scene)
        for i, b in enumerate(scene.bunches):
            world.add_solid(f"stem{i}", b.stem(at.study.stem_radius_m))
        for name in world.bodies:
            kind = next((k for k in COLORS if name.startswith(k)), "cane")
            world.paint(name, COLORS[kind])
        for name, q, tool in moments:
            if name == "basket":
                world.remove_body(f"bunch{a.bunch}")
            view.place(q, tool)
            rgb = world.picture(eye, target)
            file = f"pick_{name}.png"
            cv2.imwrite(str(folder / file), rgb[:, :, ::-1])
            written.append(file)
    return written
