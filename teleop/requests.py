"""What the console and the API ask of the robot directly, through the same safety kernel."""

from __future__ import annotations

from dataclasses import dataclass, replace

from robot_sim.commands import ArmName, ArmTarget, RobotCommand
from robot_sim.posture import Posture
from teleop.config.intent import IntentConfig
from teleop.inputs import RobotRequest
from teleop.intent_types import Mode
from teleop.kernel_state import KernelState, turn_disc
from teleop.mapping import eased_from
from teleop.modes import IN_CONTROL
from teleop.reasons import Reason


@dataclass(frozen=True, slots=True)
class Asked:
    """A request, and what decides about it: the mode, the latch, and where the robot stands (None: as it was sent)."""

    request: RobotRequest
    mode: Mode
    estop: bool
    stands: Posture | None


def apply_request(
    command: RobotCommand, asked: Asked, state: KernelState, config: IntentConfig
) -> tuple[RobotCommand, KernelState, Reason | None]:
    """Console and API: lift and disc at any time but under e-stop, the rest only while no operator is in control.

    Returns the command, the state, and why a part of the request was refused.
    """
    request = asked.request
    if asked.estop:
        return command, state, Reason.REQUEST_ESTOP
    if not request.finite:
        return command, state, Reason.REQUEST_NOT_FINITE
    command = command if request.lift_m is None else replace(command, lift_m=request.lift_m)
    if request.disc_rad is not None:
        state = turn_disc(state, request.disc_rad, asked.stands, config)
        command = replace(command, disc_rad=request.disc_rad)
    if request == RobotRequest(lift_m=request.lift_m, disc_rad=request.disc_rad):
        return command, state, None
    if asked.mode in IN_CONTROL:
        return command, state, Reason.REQUEST_ENGAGED
    if asked.mode is Mode.STOPPED:
        return command, state, Reason.BODY_STOP
    arms = dict(state.arms)
    targets: tuple[tuple[ArmName, ArmTarget | None], ...] = (
        ("right", request.right_arm),
        ("left", request.left_arm),
        ("rear", request.rear_arm),
    )
    for name, target in targets:
        if target is not None:
            arms[name] = eased_from(target)
    liquid = state.tools.liquid if request.liquid is None else request.liquid
    gripper_open = state.tools.gripper_open if request.gripper_open is None else request.gripper_open
    command = replace(
        command,
        drive_m_s=request.drive_m_s or 0.0,
        turn_rad_s=request.turn_rad_s or 0.0,
        right_arm=request.right_arm,
        left_arm=request.left_arm,
        rear_arm=request.rear_arm,
        gripper_open=request.gripper_open,
        cutter_closed=bool(request.cutter_closed),
        spray_on=bool(request.spray_on),
        liquid=liquid,
        head_camera_sweep=bool(request.head_camera_sweep),
    )
    tools = replace(state.tools, liquid=liquid, gripper_open=gripper_open)
    return command, replace(state, arms=arms, tools=tools), None
