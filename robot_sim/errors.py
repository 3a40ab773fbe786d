"""The one exception root of robot_sim: wrong calls raise, expected failures are results."""


class RobotError(Exception):
    """A call that cannot be carried out; the message says what is legal."""
