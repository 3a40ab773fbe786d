"""What a URDF is made of: shapes, links, joints and their XML. Primitives only, so that no viewer needs mesh files."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Literal

from robot_sim.config import AxisLimits

Vec3 = tuple[float, float, float]
ZERO: Vec3 = (0.0, 0.0, 0.0)
ALONG_X: Vec3 = (0.0, pi / 2, 0.0)
ALONG_Y: Vec3 = (pi / 2, 0.0, 0.0)
"""Turns of a cylinder, which lies along z by itself."""

COLOURS: dict[str, tuple[float, float, float, float]] = {
    "shell": (0.92, 0.93, 0.90, 1.0),
    "graphite": (0.17, 0.19, 0.20, 1.0),
    "leaf": (0.16, 0.52, 0.33, 1.0),
    "metal": (0.63, 0.67, 0.69, 1.0),
    "rubber": (0.075, 0.08, 0.085, 1.0),
    "signal": (0.95, 0.50, 0.10, 1.0),
    "glass": (0.05, 0.09, 0.14, 1.0),
    "water": (0.20, 0.53, 0.83, 1.0),
    "nutrient": (0.45, 0.68, 0.20, 1.0),
    "pesticide": (0.88, 0.66, 0.14, 1.0),
}


@dataclass(frozen=True, slots=True)
class Shape:
    """One primitive of a link. size: box (x, y, z), cylinder (radius, length), sphere (radius,) [m]."""

    kind: Literal["box", "cylinder", "sphere"]
    size_m: tuple[float, ...]
    xyz_m: Vec3 = ZERO
    rpy_rad: Vec3 = ZERO
    colour: str = "shell"

    def geometry_xml(self) -> str:
        """The <geometry> element."""
        if self.kind == "box":
            inner = f'<box size="{_numbers(self.size_m)}"/>'
        elif self.kind == "cylinder":
            inner = f'<cylinder radius="{self.size_m[0]:.6g}" length="{self.size_m[1]:.6g}"/>'
        else:
            inner = f'<sphere radius="{self.size_m[0]:.6g}"/>'
        return f"{origin_xml(self.xyz_m, self.rpy_rad)}<geometry>{inner}</geometry>"


def box(x: float, y: float, z: float, xyz: Vec3 = ZERO, colour: str = "shell", rpy: Vec3 = ZERO) -> Shape:
    """A box with its edges along the link's axes."""
    return Shape("box", (x, y, z), xyz, rpy, colour)


def cylinder(radius: float, length: float, xyz: Vec3 = ZERO, colour: str = "shell", rpy: Vec3 = ZERO) -> Shape:
    """A cylinder along z, or along x or y with ALONG_X, ALONG_Y."""
    return Shape("cylinder", (radius, length), xyz, rpy, colour)


def sphere(radius: float, xyz: Vec3 = ZERO, colour: str = "shell") -> Shape:
    """A sphere."""
    return Shape("sphere", (radius,), xyz, ZERO, colour)


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid part. inertia is that of a solid box of ``extent_m`` about ``com_m``."""

    name: str
    mass_kg: float
    extent_m: Vec3
    com_m: Vec3 = ZERO
    visuals: tuple[Shape, ...] = ()
    collisions: tuple[Shape, ...] = ()
    contact_xml: str = ""

    def xml(self) -> str:
        """The <link> element."""
        x, y, z = self.extent_m
        m = self.mass_kg / 12.0
        inertia = (
            f'<inertia ixx="{m * (y * y + z * z):.6g}" ixy="0" ixz="0" '
            f'iyy="{m * (x * x + z * z):.6g}" iyz="0" izz="{m * (x * x + y * y):.6g}"/>'
        )
        parts = [
            f'<link name="{self.name}">',
            f'  <inertial>{origin_xml(self.com_m)}<mass value="{self.mass_kg:.6g}"/>{inertia}</inertial>',
            *(f'  <visual>{s.geometry_xml()}<material name="{s.colour}"/></visual>' for s in self.visuals),
            *(f"  <collision>{s.geometry_xml()}</collision>" for s in self.collisions),
        ]
        if self.contact_xml:
            parts.append(f"  <contact>{self.contact_xml}</contact>")
        return "\n".join([*parts, "</link>"])


@dataclass(frozen=True, slots=True)
class Joint:
    """What connects a parent link to a child; a joint without limits is fixed, or continuous when it has an axis."""

    name: str
    parent: str
    child: str
    xyz_m: Vec3 = ZERO
    rpy_rad: Vec3 = ZERO
    axis: Vec3 | None = None
    kind: Literal["fixed", "revolute", "prismatic", "continuous"] = "fixed"
    limits: AxisLimits | None = None

    def xml(self) -> str:
        """The <joint> element."""
        parts = [
            f'<joint name="{self.name}" type="{self.kind}">',
            f'  {origin_xml(self.xyz_m, self.rpy_rad)}<parent link="{self.parent}"/><child link="{self.child}"/>',
        ]
        if self.axis is not None:
            parts.append(f'  <axis xyz="{_numbers(self.axis)}"/>')
        if self.limits is not None:
            a = self.limits
            parts.append(
                f'  <limit lower="{a.lower:.6g}" upper="{a.upper:.6g}" '
                f'effort="{a.effort:.6g}" velocity="{a.speed:.6g}"/>'
            )
        return "\n".join([*parts, "</joint>"])


def robot_xml(name: str, parts: list[Link | Joint]) -> str:
    """The whole document: materials first, then links and joints in the order given."""
    materials = [f'<material name="{n}"><color rgba="{_numbers(rgba)}"/></material>' for n, rgba in COLOURS.items()]
    body = "\n".join([*materials, *(part.xml() for part in parts)])
    return f'<?xml version="1.0"?>\n<robot name="{name}">\n{body}\n</robot>\n'


def origin_xml(xyz_m: Vec3, rpy_rad: Vec3 = ZERO) -> str:
    """The <origin> element; angles are roll, pitch, yaw about fixed axes."""
    return f'<origin xyz="{_numbers(xyz_m)}" rpy="{_numbers(rpy_rad)}"/>'


def _numbers(values: tuple[float, ...]) -> str:
    return " ".join(f"{v:.6g}" for v in values)
