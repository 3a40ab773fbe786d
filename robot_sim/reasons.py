"""Reason codes of the robot's own limiter: why a set-point was changed or refused."""

from enum import StrEnum


class RobotReason(StrEnum):
    """Codes as they appear in state, events, recordings and the console."""

    JOINT_LIMIT = "limit.joint"
    JOINT_SPEED = "limit.joint_speed"
    CHASSIS_SPEED = "limit.chassis_speed"
    CHASSIS_ACCELERATION = "limit.chassis_acceleration"
    NOT_A_NUMBER = "refused.not_a_number"
    ESTOP = "stop.estop"
    DISC_TURNING = "hold.disc_turning"
    TANK_EMPTY = "refused.tank_empty"
    CONTACT = "stop.contact"
