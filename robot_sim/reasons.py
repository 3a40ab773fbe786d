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
    ARM_DISTANCE = "hold.arm_distance"
    BODY_DISTANCE = "hold.body_distance"
    WORKSPACE = "hold.workspace"
    ARM_CONTACT = "contact.arms"
    NOT_HELD = "pick.not_held"
    NOTHING_CUT = "pick.nothing_cut"
    UNKNOWN_TOOL = "refused.unknown_tool"
    LINK_TIMEOUT = "link.timeout"
    LINK_REFUSED = "link.refused"
    LINK_LOST = "link.lost"
