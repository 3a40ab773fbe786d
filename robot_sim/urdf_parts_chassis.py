"""The crawler chassis: frame, two tracks on road wheels, tanks and battery on the deck, and the mast with its lift.

Base frame: on the floor in the middle of the tracks, x forward, y left, z up.
"""

from __future__ import annotations

from robot_sim.config import ChassisConfig, RobotConfig
from robot_sim.urdf_parts import ALONG_X, ALONG_Y, Joint, Link, Shape, Vec3, box, cylinder

DISC_HEIGHT_M = 0.40
"""The disc's top lies this far below the shoulders."""
MAST_FOOT_M = 0.05


def chassis(config: RobotConfig) -> list[Link | Joint]:
    """Base link with both tracks' road wheels."""
    c = config.chassis
    wheels_kg = 6 * c.wheel_mass_kg
    base = Link(
        "base_link",
        mass_kg=c.mass_kg - wheels_kg,
        extent_m=(c.length_m * 0.9, c.width_m * 0.8, 0.25),
        com_m=(0.0, 0.0, 0.15),
        visuals=(*_frame(config), *_tracks(config), *_tanks(config), *_battery(config), *_mast(config)),
        collisions=(
            box(c.length_m, c.width_m, c.deck_height_m - 0.06, (0.0, 0.0, 0.5 * c.deck_height_m + 0.03)),
            box(0.16, 0.16, 0.4, (0.0, 0.0, c.deck_height_m + 0.2)),
        ),
    )
    parts: list[Link | Joint] = [base]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for i, x in enumerate(wheel_positions_m(config)):
            name = f"wheel_{side}_{i}"
            parts += [_wheel(name, sign, config), _axle(name, (x, sign * track_offset_m(c), c.wheel_radius_m))]
    return parts


OUTER_WHEELS = tuple(f"wheel_{side}_{i}" for side in ("left", "right") for i in (0, 2))
"""These are dragged sideways in a turn."""


def wheel_positions_m(config: RobotConfig) -> tuple[float, float, float]:
    """x of the road wheels of one track, front to back [m]."""
    x = 0.5 * config.chassis.length_m - config.chassis.wheel_radius_m
    return (x, 0.0, -x)


def track_offset_m(chassis: ChassisConfig) -> float:
    """Distance of a track's middle from the robot's middle plane [m]."""
    return 0.5 * (chassis.width_m - chassis.track_width_m)


def lift(config: RobotConfig) -> list[Link | Joint]:
    """The carriage that rises out of the mast; its frame is the disc's top at lift zero."""
    b = config.body
    z = b.shoulder_height_m - DISC_HEIGHT_M
    rise = b.lift.upper + 0.12
    carriage = Link(
        "lift_link",
        mass_kg=8.0,
        extent_m=(0.14, 0.14, rise),
        com_m=(0.0, 0.0, -0.5 * rise),
        visuals=(
            box(0.095, 0.095, rise, (0.0, 0.0, -0.5 * rise - 0.03), "metal"),
            box(0.10, 0.022, rise, (0.0, 0.0, -0.5 * rise - 0.03), "graphite"),
            box(0.022, 0.10, rise, (0.0, 0.0, -0.5 * rise - 0.03), "graphite"),
            cylinder(0.115, 0.03, (0.0, 0.0, -0.055), "graphite"),
            cylinder(0.128, 0.018, (0.0, 0.0, -0.031), "metal"),
        ),
        collisions=(cylinder(0.128, 0.05, (0.0, 0.0, -0.045)),),
    )
    joint = Joint(
        "lift", "base_link", "lift_link", (0.0, 0.0, z), axis=(0.0, 0.0, 1.0), kind="prismatic", limits=b.lift
    )
    return [carriage, joint]


def _frame(config: RobotConfig) -> list[Shape]:
    c = config.chassis
    inner = c.width_m - 2 * c.track_width_m
    top = c.deck_height_m
    return [
        box(c.length_m * 0.90, inner - 0.02, top - 0.09, (0.0, 0.0, 0.5 * top + 0.025), "graphite"),
        box(c.length_m * 0.97, c.width_m - 0.03, 0.022, (0.0, 0.0, top - 0.030), "graphite"),
        box(c.length_m * 0.92, c.width_m - 0.08, 0.020, (0.0, 0.0, top - 0.010), "shell"),
        # nose and tail: a lamp bar and a bumper each
        *(box(0.03, inner * 0.86, 0.05, (s * c.length_m * 0.455, 0.0, 0.17), "shell") for s in (1, -1)),
        box(0.012, inner * 0.62, 0.014, (c.length_m * 0.475, 0.0, 0.175), "leaf"),
        box(0.012, inner * 0.62, 0.014, (-c.length_m * 0.475, 0.0, 0.175), "signal"),
        *(box(0.028, inner * 0.95, 0.026, (s * c.length_m * 0.472, 0.0, 0.115), "rubber") for s in (1, -1)),
    ]


def _tracks(config: RobotConfig) -> list[Shape]:
    c = config.chassis
    r, w = c.wheel_radius_m, c.track_width_m
    front, _, back = wheel_positions_m(config)
    shapes: list[Shape] = []
    for sign in (1.0, -1.0):
        y = sign * track_offset_m(c)
        outer = y + sign * (0.5 * w)
        shapes += [box(front - back, w, 2 * r - 0.008, (0.0, y, r + 0.004), "rubber")]
        shapes += [cylinder(r - 0.004, w, (x, y, r), "rubber", ALONG_Y) for x in (front, back)]
        # grousers, above and in front: they make the band read as a track
        n = 11
        pitch = (front - back) / (n - 1)
        shapes += [box(0.022, w + 0.006, 0.012, (back + k * pitch, y, 2 * r + 0.001), "rubber") for k in range(n)]
        shapes += [box(front - back, 0.008, 0.075, (0.0, outer + sign * 0.002, r), "graphite")]
        shapes += [box(c.length_m * 0.80, 0.012, 0.035, (0.0, outer - sign * 0.012, 2 * r + 0.042), "leaf")]
    return shapes


def _wheel(name: str, sign: float, config: RobotConfig) -> Link:
    c = config.chassis
    r, w = c.wheel_radius_m, c.track_width_m
    y = sign * (0.5 * w + 0.004)
    visuals = (
        cylinder(r * 0.55, 0.012, (0.0, y, 0.0), "metal", ALONG_Y),
        box(r * 0.80, 0.014, r * 0.14, (0.0, y + sign * 0.001, 0.0), "graphite"),
        box(r * 0.14, 0.014, r * 0.80, (0.0, y + sign * 0.001, 0.0), "graphite"),
    )
    # a sphere touches the floor in one point
    contact = f'<lateral_friction value="{c.track_friction:.6g}"/>'
    touching = (Shape("sphere", (r,)),)
    return Link(name, c.wheel_mass_kg, (2 * r, w, 2 * r), visuals=visuals, collisions=touching, contact_xml=contact)


def _axle(name: str, xyz: Vec3) -> Joint:
    return Joint(name, "base_link", name, xyz, axis=(0.0, 1.0, 0.0), kind="continuous")


def _tanks(config: RobotConfig) -> list[Shape]:
    c = config.chassis
    r, length = 0.068, 0.235
    x = -0.5 * c.length_m + 0.055 + 0.5 * length
    shapes: list[Shape] = [box(length * 0.9, 0.47, 0.024, (x, 0.0, c.deck_height_m + 0.012), "graphite")]
    for y, colour in ((0.155, "water"), (0.0, "nutrient"), (-0.155, "pesticide")):
        # lying in saddles, half sunk into the deck: the hanging arms and the box pass above
        z = c.deck_height_m + 0.4 * r
        shapes += [
            cylinder(r, length * 0.86, (x, y, z), colour, ALONG_X),
            cylinder(r * 0.86, length, (x, y, z), "shell", ALONG_X),
            box(0.030, 0.036, 0.026, (x, y, z + r + 0.006), "graphite"),
        ]
    return shapes


def _battery(config: RobotConfig) -> list[Shape]:
    c = config.chassis
    x, z = 0.5 * c.length_m - 0.19, c.deck_height_m
    vents = [box(0.004, 0.24, 0.007, (x + 0.121, 0.0, z + 0.035 + 0.018 * k), "graphite") for k in range(4)]
    return [
        box(0.24, 0.42, 0.115, (x, 0.0, z + 0.0575), "shell"),
        box(0.21, 0.38, 0.016, (x, 0.0, z + 0.123), "graphite"),
        box(0.244, 0.424, 0.012, (x, 0.0, z + 0.018), "leaf"),
        *vents,
        # the emergency stop on the machine itself
        box(0.060, 0.060, 0.012, (x - 0.02, 0.12, z + 0.137), "pesticide"),
        cylinder(0.022, 0.026, (x - 0.02, 0.12, z + 0.154), "signal"),
        box(0.009, 0.009, 0.20, (x + 0.07, -0.15, z + 0.22), "graphite"),
    ]


def _mast(config: RobotConfig) -> list[Shape]:
    z0 = config.chassis.deck_height_m
    z1 = config.body.shoulder_height_m - DISC_HEIGHT_M - 0.08
    height, middle = z1 - z0, 0.5 * (z0 + z1)
    return [
        cylinder(0.15, 0.03, (0.0, 0.0, z0 + 0.015), "graphite"),
        box(0.125, 0.160, height, (0.0, 0.0, middle), "shell"),
        box(0.160, 0.125, height, (0.0, 0.0, middle), "shell"),
        box(0.143, 0.143, height, (0.0, 0.0, middle), "shell"),
        # the slot of the lead screw, seen from all sides
        *(box(0.004, 0.03, height * 0.8, (s * 0.081, 0.0, middle), "graphite") for s in (1, -1)),
        *(box(0.03, 0.004, height * 0.8, (0.0, s * 0.081, middle), "graphite") for s in (1, -1)),
        box(0.172, 0.172, 0.026, (0.0, 0.0, z1 - 0.005), "graphite"),
    ]
