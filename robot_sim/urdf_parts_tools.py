"""The end effectors on the forearms' flanges: gripper with cutter (right), box (left), sprayer (rear).

Tool frame: the forearm's, z back along the forearm; with the forearm level, x points up. The cutter therefore sits
above the gripper, where a hanging fruit has its peduncle, and the box opens upwards.
"""

from __future__ import annotations

from math import cos, radians, sin

from robot_sim.config import RobotConfig
from robot_sim.urdf_parts import ZERO, Joint, Link, Shape, Vec3, box, cylinder

FINGER_M = 0.085
"""Length of a finger's pad along the forearm's direction."""
GRIP_M = 0.085
"""From the flange to the middle of the pads."""
BOX_SIZE_M: Vec3 = (0.25, 0.25, 0.12)
"""Inner size of the fruit box in its own axes: length (x, away from the robot), width (y), depth (z, open at +z)."""
BOX_WALL_M = 0.006
BOX_PITCH_RAD = radians(75.0)
"""The box is level when the forearm points this far up from straight down (c1 + bend of the elbow): a relaxed arm."""
BOX_AHEAD_M, BOX_INWARD_M, BOX_BELOW_M = 0.16, 0.08, 0.17
"""Middle of the level box beyond the flange, to the robot's right of it (held at its side), and below it."""
BOX_MIDDLE_M: Vec3 = (
    BOX_AHEAD_M * cos(BOX_PITCH_RAD) - BOX_BELOW_M * sin(BOX_PITCH_RAD),
    -BOX_INWARD_M,
    -BOX_AHEAD_M * sin(BOX_PITCH_RAD) - BOX_BELOW_M * cos(BOX_PITCH_RAD),
)
"""The same in the forearm's axes, from the flange."""
BOX_RPY: Vec3 = (0.0, BOX_PITCH_RAD, 0.0)
"""Turn of the box in the forearm's axes."""
SOFT_XML = '<stiffness value="3000"/><damping value="40"/>'
"""Foam on the fingers' pads [N/m, Ns/m]: 15 mm of soft polyurethane give 5 mm under a 14 N grip."""
LINING_XML = '<stiffness value="1500"/><damping value="10"/>'
"""Foam that lines the box: twice as thick, open-pored, so that a bunch that falls 6 cm is not bruised."""
CUPPED_XML = '<stiffness value="1200"/><damping value="30"/>'
"""The soft gripper's silicone [N/m, Ns/m]."""
CUT_MIDDLE_M: Vec3 = (0.055, 0.0, -0.100)
CUT_HALF_M: Vec3 = (0.040, 0.034, 0.045)
"""Between the blades: a peduncle in here is cut when they close; from the flange, in the forearm's axes."""
NOZZLE_M = 0.07
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
            _finger(f"{name}_link", sign, config.tool.gripper),
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
    """The open box before the left hand that takes the picked fruit; ``left_box`` is its middle, z up when level."""
    length, width, depth = BOX_SIZE_M
    t = BOX_WALL_M
    top = 0.5 * depth
    floor = box(length, width, t, (0.0, 0.0, -top), "leaf")
    sides = [box(length, t, depth, (0.0, s * 0.5 * width, 0.0), "leaf") for s in (1.0, -1.0)]
    ends = [box(t, width, depth, (s * 0.5 * length, 0.0, 0.0), "leaf") for s in (1.0, -1.0)]
    rim = [box(length + 0.012, 0.012, 0.012, (0.0, s * 0.5 * width, top), "shell") for s in (1.0, -1.0)]
    rim += [box(0.012, width + 0.012, 0.012, (s * 0.5 * length, 0.0, top), "shell") for s in (1.0, -1.0)]
    walls: tuple[Shape, ...] = (floor, *sides, *ends)
    # to the physics the walls are thick outwards: a fruit that falls 15 mm in a tick does not pass one
    thick = 0.02
    hull = (
        box(length, width, thick, (0.0, 0.0, -top - 0.5 * (thick - t))),
        *(box(length, thick, depth, (0.0, s * 0.5 * (width + thick - t), 0.0)) for s in (1.0, -1.0)),
        *(box(thick, width, depth, (s * 0.5 * (length + thick - t), 0.0, 0.0)) for s in (1.0, -1.0)),
    )
    crate = Link(
        "left_box",
        mass_kg=config.tool.box_kg,
        extent_m=BOX_SIZE_M,
        visuals=(*walls, *rim),
        collisions=hull,
        contact_xml=LINING_XML,
    )
    hand = Link(
        "left_tool",
        mass_kg=config.arm.tool_kg,
        extent_m=(0.05, 0.12, 0.10),
        com_m=(0.0, 0.0, -0.03),
        visuals=(
            box(0.052, 0.100, 0.026, (0.0, 0.0, -0.020), "graphite"),
            box(0.036, 0.104, 0.008, (0.0, 0.0, -0.031), "metal"),
            # two brackets from the flange down to the box's near rim
            *(
                box(0.020, 0.014, 0.110, (-0.026, s * 0.046 - 0.02, -0.065), "graphite", (0.0, 0.45, 0.0))
                for s in (1.0, -1.0)
            ),
        ),
        collisions=(box(0.052, 0.100, 0.026, (0.0, 0.0, -0.020)),),
    )
    return [
        hand,
        Joint("left_flange", "left_forearm", hand.name, (0.0, 0.0, -config.arm.forearm_m)),
        crate,
        Joint("left_box_mount", hand.name, crate.name, BOX_MIDDLE_M, BOX_RPY),
    ]


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


def _finger(name: str, sign: float, gripper: str) -> Link:
    """A pad that gives, on a stiff back. long: flat and narrow; soft: high, short, very soft, with a lip below."""
    soft = gripper == "soft"
    high, long = (0.060, 0.070) if soft else (0.034, FINGER_M)
    z = -0.046 - 0.5 * FINGER_M
    back = box(0.030, 0.010, FINGER_M + 0.02, (0.0, sign * 0.013, z + 0.010), "graphite")
    visuals = [back, box(high, 0.008, long, (0.0, sign * 0.004, z), "leaf")]
    touching = [box(high, 0.018, long, (0.0, sign * 0.009, z))]
    if soft:
        # curled fingertips
        lip = box(high, 0.016, 0.010, (0.0, sign * -0.004, z - 0.5 * long), "leaf")
        visuals.append(lip)
        touching.append(lip)
    contact = f'<lateral_friction value="1.1"/><spinning_friction value="0.02"/>{CUPPED_XML if soft else SOFT_XML}'
    middle = (0.0, sign * 0.009, -0.08)
    return Link(name, 0.08, (0.03, 0.02, FINGER_M), middle, tuple(visuals), tuple(touching), contact)
