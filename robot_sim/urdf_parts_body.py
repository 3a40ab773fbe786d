"""The upper body on the rotating disc: torso with shoulders, and the head camera on its turning base.

Disc frame: on the disc's top in the middle, x where the chest faces, y left, z up.
"""

from __future__ import annotations

from math import cos, sin

from robot_sim.config import RobotConfig
from robot_sim.urdf_parts import ALONG_X, ALONG_Y, Joint, Link, Shape, box, cylinder
from robot_sim.urdf_parts_chassis import DISC_HEIGHT_M

HEAD_HEIGHT_M = DISC_HEIGHT_M + 0.150


def upper_body(config: RobotConfig) -> list[Link | Joint]:
    """Disc link with the torso, turned by ``chest_yaw_rad`` at disc zero."""
    torso = Link(
        "disc_link",
        mass_kg=config.body.upper_body_kg,
        extent_m=(0.22, 0.36, 0.45),
        com_m=(0.0, 0.0, 0.22),
        visuals=(*_disc(), *_torso(), *_shoulders(config)),
        collisions=(
            cylinder(0.132, 0.05, (0.0, 0.0, 0.0)),
            box(0.16, 0.24, 0.34, (0.0, 0.0, 0.28)),
        ),
    )
    yaw = (0.0, 0.0, config.body.chest_yaw_rad)
    axis = (0.0, 0.0, 1.0)
    joint = Joint("disc", "lift_link", "disc_link", rpy_rad=yaw, axis=axis, kind="revolute", limits=config.body.disc)
    return [torso, joint]


def head(config: RobotConfig) -> list[Link | Joint]:
    """Turning base with a two-eyed camera; ``head_camera`` is the optical centre, x forward along the view."""
    tilt = config.body.head_tilt_rad
    turned = (0.0, tilt, 0.0)
    forward, down = cos(tilt), -sin(tilt)
    eye_x, eye_z = 0.035 * forward, 0.055 + 0.035 * down
    along_view = (0.0, ALONG_X[1] + tilt, 0.0)
    lens = [
        cylinder(r, 0.016, (eye_x + 0.004 * k * forward, y, eye_z + 0.004 * k * down), colour, along_view)
        for y in (0.045, -0.045)
        for k, (r, colour) in enumerate(((0.024, "graphite"), (0.018, "glass")))
    ]
    link = Link(
        "head_link",
        mass_kg=0.6,
        extent_m=(0.08, 0.16, 0.08),
        com_m=(0.0, 0.0, 0.04),
        visuals=(
            cylinder(0.046, 0.018, (0.0, 0.0, 0.0), "graphite"),
            box(0.042, 0.060, 0.05, (0.0, 0.0, 0.025), "graphite"),
            box(0.062, 0.165, 0.062, (0.0, 0.0, 0.055), "shell", turned),
            cylinder(0.031, 0.062, (0.0, 0.0825, 0.055), "shell", along_view),
            cylinder(0.031, 0.062, (0.0, -0.0825, 0.055), "shell", along_view),
            box(0.004, 0.150, 0.050, (0.030 * forward, 0.0, 0.055 + 0.030 * down), "graphite", turned),
            box(0.03, 0.13, 0.008, (0.0, 0.0, 0.091), "leaf", turned),
            *lens,
        ),
    )
    pan = Joint(
        "head_pan",
        "disc_link",
        "head_link",
        (0.02, 0.0, HEAD_HEIGHT_M),
        axis=(0.0, 0.0, 1.0),
        kind="revolute",
        limits=config.body.head_pan,
    )
    eye = Link("head_camera", 0.01, (0.01, 0.01, 0.01))
    fixed = Joint("head_camera_mount", "head_link", "head_camera", (eye_x + 0.02 * forward, 0.0, eye_z), turned)
    return [link, pan, eye, fixed]


def _disc() -> list[Shape]:
    return [
        cylinder(0.128, 0.022, (0.0, 0.0, -0.009), "leaf"),
        cylinder(0.132, 0.014, (0.0, 0.0, 0.009), "shell"),
        cylinder(0.085, 0.075, (0.0, 0.0, 0.05), "graphite"),
        # where the chest faces, marked on the disc
        box(0.030, 0.050, 0.016, (0.114, 0.0, 0.012), "signal"),
    ]


def _torso() -> list[Shape]:
    z = 0.215
    return [
        cylinder(0.066, 0.10, (0.0, 0.0, 0.12), "metal"),
        # chest: a box with rounded flanks
        box(0.150, 0.140, 0.215, (0.0, 0.0, z + 0.06), "shell"),
        cylinder(0.075, 0.215, (0.0, 0.070, z + 0.06), "shell"),
        cylinder(0.075, 0.215, (0.0, -0.070, z + 0.06), "shell"),
        box(0.120, 0.160, 0.030, (0.0, 0.0, z + 0.180), "shell"),
        box(0.154, 0.136, 0.014, (0.0, 0.0, z - 0.030), "leaf"),
        # chest plate with a status lamp
        box(0.006, 0.110, 0.100, (0.076, 0.0, z + 0.075), "graphite"),
        box(0.006, 0.075, 0.010, (0.080, 0.0, z + 0.105), "leaf"),
        box(0.008, 0.022, 0.022, (0.079, 0.0, z + 0.055), "signal"),
        # neck
        cylinder(0.040, 0.125, (0.02, 0.0, DISC_HEIGHT_M + 0.0575), "graphite"),
        cylinder(0.050, 0.022, (0.02, 0.0, DISC_HEIGHT_M + 0.130), "metal"),
    ]


def _shoulders(config: RobotConfig) -> list[Shape]:
    a = config.arm
    back = a.rear_offset_m
    shapes: list[Shape] = []
    for sign in (1.0, -1.0):
        inner = 0.06
        outer = a.shoulder_offset_m - 0.035
        length, middle = outer - inner, 0.5 * (outer + inner)
        shapes += [
            cylinder(0.042, length, (a.forward_offset_m, sign * middle, DISC_HEIGHT_M), "graphite", ALONG_Y),
            cylinder(0.060, 0.020, (a.forward_offset_m, sign * (outer + 0.003), DISC_HEIGHT_M), "leaf", ALONG_Y),
        ]
    shapes += [
        box(back - 0.05, 0.070, 0.070, (-0.5 * back - 0.01, 0.036, DISC_HEIGHT_M - 0.01), "graphite"),
        box(0.090, 0.036, 0.110, (-back, 0.056, DISC_HEIGHT_M), "graphite"),
    ]
    return shapes
