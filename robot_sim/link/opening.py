"""From a robot's URI to the link that drives it."""

from __future__ import annotations

from robot_sim.config import RobotConfig
from robot_sim.errors import RobotError
from robot_sim.link.robot_link import RobotLink

LEGAL = "pybullet: (the simulation) or serial:PORT (a servo controller, for instance serial:/dev/ttyUSB0)"


def open_robot(uri: str, config: RobotConfig | None = None, seed: int = 0) -> RobotLink:
    """The robot of a URI: ``pybullet:`` or ``serial:PORT``.

    Raises RobotError for another URI, a port that cannot be opened and a controller that does not answer.
    """
    scheme, colon, rest = uri.partition(":")
    # each loads its library only when it is asked for
    if scheme == "pybullet" and not rest:
        from robot_sim.world import World

        return World(config, seed)
    if scheme == "serial" and colon and rest:
        try:
            from robot_sim.link.serial_robot import SerialRobot
        except ModuleNotFoundError:
            raise RobotError("pyserial is not installed; pip install 'greenhouse-teleop[sensors]'") from None
        return SerialRobot(rest, config)
    raise RobotError(f"'{uri}' is no robot; legal: {LEGAL}")
