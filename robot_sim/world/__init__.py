"""The simulated robot in its greenhouse; the only part of the project that loads PyBullet for the robot."""

from robot_sim.world.world import World

__all__ = ["World"]
