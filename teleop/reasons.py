"""Reason codes of intent and safety: nothing is clamped, held, refused, stopped or changed without one of these."""

from enum import StrEnum


class Reason(StrEnum):
    """Codes as they appear in intent, command, events, recordings and the console.

    hold.*: the robot keeps its place for now. stop.*: everything stands still. refused.*: an input was not used.
    limit.*: a value was used after being changed. mode.*: why the mode changed. assist.*: the assisted pick.
    """

    # hold: resumes by itself
    TRACKING_LOST = "hold.tracking_lost"
    LOW_CONFIDENCE = "hold.low_confidence"
    SHORT_PROJECTION = "hold.short_projection"
    ARM_UNKNOWN = "hold.arm_unknown"
    NOT_FACING = "hold.not_facing"
    ZONE_UNSETTLED = "hold.zone_unsettled"
    TASK_UNSETTLED = "hold.task_unsettled"
    GESTURE = "hold.gesture"
    CROSSING = "hold.crossing"
    HAND_UNKNOWN = "hold.hand_unknown"
    HAND_NOT_CHANGED = "hold.hand_not_changed"
    HAND_HANGING = "hold.hand_hanging"
    ARM_LOCKED = "hold.arm_locked"
    DISC_TURNING = "hold.disc_turning"
    NOT_ENGAGED = "hold.not_engaged"
    NO_FRAME_HOLD = "hold.no_frame"

    ASSIST_AIMING = "hold.assist_aiming"
    ASSIST_PREVIEW = "hold.assist_preview"
    ASSIST_CLOSE_HANDS = "hold.assist_close_hands"

    # stop
    ESTOP = "stop.estop"
    BODY_STOP = "stop.body"
    OUT_OF_RANGE = "stop.out_of_range"
    NO_PERSON = "stop.no_person"
    NO_FRAME_STOP = "stop.no_frame"
    SOURCE_FAILED = "stop.source_failed"

    # refused
    FRAME_DUPLICATE = "refused.frame_duplicate"
    FRAME_REORDERED = "refused.frame_reordered"
    FRAME_STALE = "refused.frame_stale"
    FRAME_FUTURE = "refused.frame_future"
    FRAME_BLANK = "refused.frame_blank"
    FRAME_SATURATED = "refused.frame_saturated"
    FRAME_FROZEN = "refused.frame_frozen"
    FLOOR_JUMP = "refused.floor_jump"
    JOINT_NOT_FINITE = "refused.joint_not_finite"
    JOINT_JUMP = "refused.joint_jump"
    BONE_LENGTH = "refused.bone_length"
    OPERATOR_JUMP = "refused.operator_jump"
    ENGAGE_NO_PERSON = "refused.engage_no_person"
    ENGAGE_ESTOP = "refused.engage_estop"
    REQUEST_NOT_FINITE = "refused.request_not_finite"
    REQUEST_ENGAGED = "refused.request_operator_engaged"
    REQUEST_ESTOP = "refused.request_estop"

    ASSIST_NO_ROBOT = "refused.assist_no_robot"
    ASSIST_NOT_PICKING = "refused.assist_not_picking"
    ASSIST_BUSY = "refused.assist_busy"

    # limit
    SHOULDER_RANGE = "limit.shoulder_range"
    ELBOW_RANGE = "limit.elbow_range"
    EASE_IN = "limit.ease_in"

    # the assisted pick: what it does, and why it ended
    ASSIST_RUNNING = "assist.running"
    ASSIST_DONE = "assist.done"
    ASSIST_HAND_OPENED = "assist.hand_opened"
    ASSIST_HANDS_UNKNOWN = "assist.hands_unknown"
    ASSIST_LEFT = "assist.left_picking"
    ASSIST_OPERATOR = "assist.operator_engaged"
    ASSIST_REQUEST = "assist.request"
    ASSIST_CANCELLED = "assist.cancelled"
    ASSIST_REPLACED = "assist.replaced"
    ASSIST_DECLINED = "assist.declined"
    ASSIST_TIMEOUT = "assist.timeout"
    ASSIST_RESTARTED = "assist.restarted"
    ASSIST_LEASE = "assist.lease_lost"

    # why a mode changed
    PERSON_SEEN = "mode.person_seen"
    PERSON_LEFT = "mode.person_left"
    ENGAGE_GESTURE = "mode.engage_gesture"
    ENGAGE_REQUEST = "mode.engage_request"
    ENGAGE_ASSUMED = "mode.engage_assumed"
    DISENGAGE_GESTURE = "mode.disengage_gesture"
    DISENGAGE_REQUEST = "mode.disengage_request"
    ZONE_ENTERED = "mode.zone_entered"
    TASK_SETTLED = "mode.task_settled"
    RESUMED = "mode.resumed"
    OPERATOR_CHANGED = "mode.operator_changed"
    STREAM_RESTARTED = "mode.stream_restarted"
    ESTOP_RESET = "mode.estop_reset"
