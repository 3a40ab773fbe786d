"""The end effectors on the forearms' flanges: gripper with cutter (right), box (left), sprayer (rear).

Tool frame: the forearm's, z back along the forearm; with the forearm level, x points up. The cutter therefore sits
above the gripper, where a hanging fruit has its peduncle, and the box opens upwards.
"""

from __future__ import annotations

from robot_sim.config import RobotConfig
from robot_sim.urdf_parts import ZERO, Joint, Link, Shape, Vec3, box, cylinder

FINGER_M = 0.085
"""Length of a finger's pad along the forearm's direction."""
GRIP_M = 0.085
"""From the flange to the middle of the pads."""
BOX_SIZE_M: Vec3 = (0.11, 0.19, 0.19)
"""Inner size of the fruit box in the forearm's axes: depth (x, open at +x), width (y), length (z)."""
BOX_WALL_M = 0.006
BOX_MIDDLE_M: Vec3 = (0.015, 0.0, -0.5 * BOX_SIZE_M[2] - 0.02)
"""Middle of the box in the forearm's axes, from the flange."""
CUT_MIDDLE_M: Vec3 = (0.055, 0.0, -0.100)
CUT_HALF_M: Vec3 = (0.040, 0.034, 0.045)
"""Between the blades: a peduncle in here is cut when they close; from the flange, in the forearm's axes."""
NOZZLE_M = 0.14
"""From the flange to the nozzles' mouths."""


def gripper(config: RobotConfig) -> list[Link | Joint]:
    """Palm, two parallel jaws along y, and the cutter's blade above them."""
    flange = -config.arm.forearm_m
    palm = Link(
        "right_tool",
        mass_kg=config.arm.tool_kg,
        extent_m=(0.05, 0.12, 0.05),
        com_m=(0.0, 0.0, -0.02),
        visuals=(
            box(0.052, 0.150, 0.026, (0.0, 0.0, -0.025), "graphite"),
            box(0.036, 0.156, 0.008, (0.0, 0.0, -0.036), "metal"),
            # the cutter's arm and fixed blade
            box(0.014, 0.028, 0.070, (0.040, -0.030, -0.055), "graphite"),
            box(0.003, 0.012, 0.060, (0.048, -0.030, -0.108), "metal"),
        ),
        collisions=(box(0.052, 0.150, 0.040, (0.0, 0.0, -0.022)),),
    )
    parts: list[Link | Joint] = [palm, Joint("right_flange", "right_forearm", "right_tool", (0.0, 0.0, flange))]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        name = f"gripper_{side}"
        parts += [
            _finger(f"{name}_link", sign),
            Joint(name, "right_tool", f"{name}_link", ZERO, ZERO, (0.0, sign, 0.0), "prismatic", config.tool.jaw),
        ]
    blade = Link(
        "cutter_link",
        mass_kg=0.05,
        extent_m=(0.01, 0.02, 0.07),
        com_m=(0.0, 0.0, -0.04),
        visuals=(
            box(0.012, 0.020, 0.020, ZERO, "signal"),
            box(0.004, 0.016, 0.070, (0.0, 0.0, -0.040), "signal"),
        ),
    )
    # from open (0) the blade swings across the middle line onto the fixed one
    hinge = Joint(
        "cutter", "right_tool", "cutter_link", (0.052, 0.026, -0.062), ZERO, (-1.0, 0.0, 0.0), "revolute",
        config.tool.cutter,
    )  # fmt: skip
    return [*parts, blade, hinge]


def fruit_box(config: RobotConfig) -> list[Link | Joint]:
    """The open box on the left forearm that takes the picked fruit."""
    depth, width, length = BOX_SIZE_M
    t = BOX_WALL_M
    x, _, z = BOX_MIDDLE_M
    floor = box(t, width, length, (x - 0.5 * depth, 0.0, z), "leaf")
    sides = [box(depth, t, length, (x, s * 0.5 * width, z), "leaf") for s in (1.0, -1.0)]
    ends = [box(depth, width, t, (x, 0.0, z + s * 0.5 * length), "leaf") for s in (1.0, -1.0)]
    rim_x = x + 0.5 * depth
    rim = [box(0.012, 0.012, length + 0.012, (rim_x, s * 0.5 * width, z), "shell") for s in (1.0, -1.0)]
    rim += [box(0.012, width + 0.012, 0.012, (rim_x, 0.0, z + s * 0.5 * length), "shell") for s in (1.0, -1.0)]
    walls: tuple[Shape, ...] = (floor, *sides, *ends)
    # to the physics the walls are thick outwards: a fruit that falls 15 mm in a tick does not pass one
    thick = 0.02
    hull = (
        box(thick, width, length, (x - 0.5 * (depth + thick - t), 0.0, z)),
        *(box(depth, thick, length, (x, s * 0.5 * (width + thick - t), z)) for s in (1.0, -1.0)),
        *(box(depth, width, thick, (x, 0.0, z + s * 0.5 * (length + thick - t))) for s in (1.0, -1.0)),
    )
    link = Link(
        "left_tool",
        mass_kg=config.arm.tool_kg,
        extent_m=(depth, width, length),
        com_m=(x, 0.0, z),
        visuals=(*walls, *rim),
        collisions=hull,
    )
    return [link, Joint("left_flange", "left_forearm", "left_tool", (0.0, 0.0, -config.arm.forearm_m))]


def sprayer(config: RobotConfig) -> list[Link | Joint]:
    """Three nozzles side by side, one for each tank."""
    shapes: list[Shape] = [
        box(0.044, 0.120, 0.045, (0.0, 0.0, -0.034), "shell"),
        box(0.022, 0.130, 0.022, (0.028, 0.0, -0.034), "graphite"),
    ]
    for y, colour in ((0.040, "water"), (0.0, "nutrient"), (-0.040, "pesticide")):
        shapes += [
            cylinder(0.012, 0.055, (0.0, y, -0.084), colour),
            box(0.022, 0.026, 0.028, (0.0, y, -NOZZLE_M + 0.014), "graphite"),
            # its hose along the forearm
            box(0.010, 0.010, 0.160, (0.033, y * 0.40, 0.065), colour),
        ]
    link = Link(
        "rear_tool",
        mass_kg=config.arm.tool_kg,
        extent_m=(0.05, 0.12, NOZZLE_M),
        com_m=(0.0, 0.0, -0.06),
        visuals=tuple(shapes),
        collisions=(box(0.044, 0.12, NOZZLE_M, (0.0, 0.0, -0.5 * NOZZLE_M)),),
    )
    return [link, Joint("rear_flange", "rear_forearm", "rear_tool", (0.0, 0.0, -config.arm.forearm_m))]


def _finger(name: str, sign: float) -> Link:
    # a pad that gives: soft rubber on a stiff back
    back = box(0.030, 0.010, FINGER_M + 0.02, (0.0, sign * 0.013, -0.036 - 0.5 * FINGER_M), "graphite")
    pad = box(0.034, 0.008, FINGER_M, (0.0, sign * 0.004, -0.046 - 0.5 * FINGER_M), "leaf")
    contact = '<lateral_friction value="1.1"/><spinning_friction value="0.02"/>'
    touching = (box(0.034, 0.018, FINGER_M, (0.0, sign * 0.009, -0.046 - 0.5 * FINGER_M)),)
    middle = (0.0, sign * 0.009, -0.08)
    return Link(name, 0.08, (0.03, 0.02, FINGER_M), middle, (back, pad), touching, contact)
