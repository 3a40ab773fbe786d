"""What drives a robot: one interface, the simulation and a serial servo controller behind it."""

from robot_sim.link.opening import open_robot
from robot_sim.link.robot_link import RobotLink

__all__ = ["RobotLink", "open_robot"]
