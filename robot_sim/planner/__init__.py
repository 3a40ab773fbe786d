"""Path planning: potential field over bounding solids with escape from local minima, key points, RRT-Connect."""

from robot_sim.planner.key_points import key_points, path_length, thinned
from robot_sim.planner.potential_field import FieldConfig, PathReason, PathResult, plan_path
from robot_sim.planner.rrt_connect import RrtResult, rrt_connect
from robot_sim.planner.scene import Scene
from robot_sim.planner.shapes import Box, Cylinder, Solid, Sphere, box, sphere, upright_cylinder

__all__ = [
    "Box",
    "Cylinder",
    "FieldConfig",
    "PathReason",
    "PathResult",
    "RrtResult",
    "Scene",
    "Solid",
    "Sphere",
    "box",
    "key_points",
    "path_length",
    "plan_path",
    "rrt_connect",
    "sphere",
    "thinned",
    "upright_cylinder",
]
