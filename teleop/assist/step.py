"""One step of the assisted pick: what was asked, what the operator shows, what the robot is told. Pure.

The robot moves only while a pick is running; it is held while a preview is open or an operator aims; everything it is
told passes the kernel and the robot's limiter like any other command.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from robot_sim.commands import RobotCommand
from robot_sim.pick.plan import PickPlan, plan_pick, where_fruits_are
from robot_sim.pick.refusal import Refusal
from robot_sim.pick.run import begin, hold
from robot_sim.pick.run import step as step_run
from robot_sim.pick.targets import nearest_ripe
from robot_sim.stance import stance_of
from teleop.assist.aim import F64, Aim, arm_direction, pointed_at, step_aim
from teleop.assist.hands_rule import both_closed, step_confirmation, takes_over
from teleop.assist.task import Confirmation, PickTask, RobotView, TaskStatus
from teleop.config.assist import AssistConfig
from teleop.inputs import PickAsk
from teleop.intent_types import Event, Hand, Hands, Mode, Side
from teleop.modes import IN_CONTROL
from teleop.reasons import Reason
from teleop.skeleton import Skeleton


@dataclass(frozen=True, slots=True, eq=False)
class AssistState:
    """task: the newest one, also after its end. ended: those that ended in the last step beside it. holding: the
    operator's arms and hands drove nothing in the last step."""

    task: PickTask | None = None
    aim: Aim = field(default_factory=Aim)
    ended: tuple[PickTask, ...] = ()
    holding: bool = False

    @property
    def active(self) -> PickTask | None:
        """The task that holds the robot, if any."""
        return self.task if self.task is not None and self.task.active else None


@dataclass(frozen=True, slots=True, eq=False)
class Situation:
    """What a step must know beside the robot.

    hands: in their roles. body: of the operator, levelled, None when not seen now. pointing: the side of the arm that
    points. raised: the other hand is beside the head. dt_s: 0 when the frame tells nothing new. still: why the
    operator's commands do not count now. stopped: why the robot stands (e-stop, body stop, no frames). manual: the API
    drives the robot itself in this step.
    """

    t_ns: int
    mode: Mode
    hands: Hands = field(default_factory=Hands)
    body: Skeleton | None = None
    pointing: Side = "right"
    raised: bool = False
    dt_s: float = 0.0
    still: Reason | None = None
    stopped: Reason | None = None
    manual: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Assisted:
    """What a step came to. wish: what the robot is asked, None when the pick asks nothing. holds: the operator's arms
    and hands drive nothing. stops: the robot drops its goals and brakes."""

    state: AssistState
    wish: RobotCommand | None = None
    holds: bool = False
    stops: bool = False
    reasons: tuple[str, ...] = ()
    events: tuple[Event, ...] = ()


def step_assist(
    state: AssistState, now: Situation, asks: Iterable[PickAsk], view: RobotView | None, config: AssistConfig
) -> Assisted:
    """One step; nothing happens without a robot that is known."""
    before = state.task
    state = replace(state, ended=())
    events: list[Event] = []
    for ask in asks:
        state = _asked(state, ask, now, view)
    if view is None:
        return Assisted(state, events=tuple(events))
    task, stops = state.active, False
    if task is not None and (end := _why_ended(task, now)) is not None:
        stops = _runs(task)
        status = TaskStatus.TAKEN_OVER if stops else TaskStatus.CANCELLED
        state = replace(state, task=task.ended(status, end))
    # whatever ended a run, the goals already sent are dropped
    stops = stops or (_runs(before) and state.active is None)
    wish, reasons, waits = None, tuple[str, ...](), False
    if now.mode is Mode.PICKING and config.pointing == "on" and not _runs(state.active):
        state, reasons = _aimed(state, now, view, config)
    if (task := state.active) is not None:
        task, wish, reasons, waits = _go_on(task, now, view, config)
        state = replace(state, task=task)
    for ended in state.ended:
        events += _told(None if before is None or before.id != ended.id else before, ended, now.t_ns)
    events += _told(before, state.task, now.t_ns)
    holds = bool(reasons) or state.active is not None
    # where the operator's arms were going is dropped, too
    stops = stops or waits or (holds and not state.holding and wish is None)
    return Assisted(replace(state, holding=holds), wish, holds, stops, tuple(map(str, reasons)), tuple(events))


def _runs(task: PickTask | None) -> bool:
    return task is not None and task.status is TaskStatus.RUNNING


def _replaced(state: AssistState, task: PickTask) -> AssistState:
    """A new task in the place of the one before, which is cancelled if it is under way."""
    old = state.task
    if old is not None and old.active:
        old = old.ended(TaskStatus.CANCELLED, Reason.ASSIST_REPLACED)
    return replace(state, task=task, ended=state.ended if old is None else (*state.ended, old))


def _asked(state: AssistState, ask: PickAsk, now: Situation, view: RobotView | None) -> AssistState:
    task = state.active
    if ask.action == "cancel":
        if task is None or task.id != ask.id:
            return state
        status = TaskStatus.TAKEN_OVER if _runs(task) else TaskStatus.CANCELLED
        return replace(state, task=task.ended(status, ask.reason))
    if ask.action == "confirm":
        # an operator in control confirms with the fist and nothing else
        if task is None or task.id != ask.id or task.status is not TaskStatus.PREVIEW or task.attended:
            return state
        return replace(state, task=replace(task, confirmation=Confirmation(confirmed=True)))
    if task is not None and _runs(task):
        refused = PickTask(ask.id, ask.fruit or "", False, TaskStatus.REFUSED)
        detail = f"{task.fruit} is being picked; wait for its end, or cancel it"
        return replace(state, ended=(*state.ended, refused.ended(TaskStatus.REFUSED, Reason.ASSIST_BUSY, detail)))
    return _replaced(state, _opened(ask, now, view))


def _opened(ask: PickAsk, now: Situation, view: RobotView | None) -> PickTask:
    """A preview, or the refusal with what to do."""
    attended = now.mode in IN_CONTROL
    task = PickTask(ask.id, ask.fruit or "", attended, TaskStatus.PREVIEW)
    if view is None:
        return task.ended(TaskStatus.REFUSED, Reason.ASSIST_NO_ROBOT, "no robot is connected; open one first")
    if now.stopped is not None:
        return task.ended(TaskStatus.REFUSED, now.stopped, "the robot is stopped; release the stop, then ask again")
    if attended and now.mode is not Mode.PICKING:
        detail = "the operator must be picking: in the work zone, legs apart; or disengage them"
        return task.ended(TaskStatus.REFUSED, Reason.ASSIST_NOT_PICKING, detail)
    found: PickPlan | Refusal
    if ask.fruit is None:
        fruit, found = nearest_ripe(view.scenery, view.state, view.config)
    else:
        fruit, found = ask.fruit, plan_pick(ask.fruit, view.scenery, view.state, view.config)
    task = replace(task, fruit=fruit)
    if isinstance(found, Refusal):
        return replace(task.ended(TaskStatus.REFUSED, found.reason, found.detail), forward_m=found.forward_m)
    # who commands without an operator has decided already, unless they want to look first
    confirmed = not attended and not ask.preview
    return replace(task, plan=found, opened_s=view.state.sim_time_s, confirmation=Confirmation(confirmed=confirmed))


def _why_ended(task: PickTask, now: Situation) -> Reason | None:
    """Why a task ends at this step whatever the robot does; None when nothing ends it."""
    if now.stopped is not None:
        return now.stopped
    if not task.attended:
        if now.mode in IN_CONTROL:
            return Reason.ASSIST_OPERATOR
        return Reason.ASSIST_REQUEST if now.manual and task.status is TaskStatus.RUNNING else None
    if now.mode is not Mode.PICKING:
        lost = {Mode.HELD: Reason.TRACKING_LOST, Mode.NO_PERSON: Reason.NO_PERSON, Mode.SEEN: Reason.NOT_ENGAGED}
        return lost.get(now.mode, Reason.ASSIST_LEFT)
    if task.status is TaskStatus.RUNNING:
        if now.manual:
            return Reason.ASSIST_REQUEST
        if takes_over(now.hands):
            return Reason.ASSIST_HAND_OPENED
    return None


def _go_on(
    task: PickTask, now: Situation, view: RobotView, config: AssistConfig
) -> tuple[PickTask, RobotCommand | None, tuple[str, ...], bool]:
    """A preview or a run, one step on: task, wish, reasons, and whether the robot waits."""
    if task.status is TaskStatus.PREVIEW:
        if task.attended and now.dt_s > 0:
            task = replace(task, confirmation=step_confirmation(task.confirmation, now.hands))
        if view.state.sim_time_s - task.opened_s > config.preview_s:
            return task.ended(TaskStatus.CANCELLED, Reason.ASSIST_TIMEOUT), None, (), False
        if not task.confirmation.confirmed:
            return task, None, (Reason.ASSIST_PREVIEW,) if task.attended else (), False
        if task.attended and not both_closed(now.hands):
            return task, None, (Reason.ASSIST_CLOSE_HANDS,), False
        task = _started(task, view)
        if not task.active:
            return task, None, (), False
    run = task.run
    assert run is not None
    wait = now.still
    if task.attended:
        unread = Hand.UNKNOWN in (now.hands.right, now.hands.left)
        task = replace(task, unread_s=task.unread_s + now.dt_s if unread else 0.0)
        if task.unread_s > config.unknown_s:
            return task.ended(TaskStatus.TAKEN_OVER, Reason.ASSIST_HANDS_UNKNOWN), None, (), True
        wait = wait or (Reason.HAND_UNKNOWN if unread else None)
        wait = wait or (Reason.TRACKING_LOST if now.body is None else None)
    if wait is not None:
        return replace(task, run=hold(run, view.state)), None, (Reason.ASSIST_RUNNING, wait), True
    run, wish = step_run(run, view.scenery, view.state, view.config)
    task = replace(task, run=run, plan=run.plan)
    if run.failure is not None:
        ended = task.ended(TaskStatus.FAILED, run.failure.reason, run.failure.detail)
        return replace(ended, forward_m=run.failure.forward_m), None, (str(run.failure.reason),), True
    if run.done:
        return task.ended(TaskStatus.SUCCEEDED, Reason.ASSIST_DONE), wish, (), False
    return task, wish, (Reason.ASSIST_RUNNING,), False


def _started(task: PickTask, view: RobotView) -> PickTask:
    """The run of a confirmed preview, planned anew: the lift may have moved meanwhile."""
    found = plan_pick(task.fruit, view.scenery, view.state, view.config)
    if isinstance(found, Refusal):
        return replace(task.ended(TaskStatus.FAILED, found.reason, found.detail), forward_m=found.forward_m)
    return replace(task, status=TaskStatus.RUNNING, plan=found, run=begin(found, view.state, view.config))


def _aimed(
    state: AssistState, now: Situation, view: RobotView, config: AssistConfig
) -> tuple[AssistState, tuple[str, ...]]:
    """The operator chooses a fruit by pointing, or declines a preview by pointing at none; the arms hold meanwhile."""
    body = now.body if now.still is None else None
    direction = None if body is None else arm_direction(body, now.pointing, config)

    def choose(line: F64, before: str | None) -> str | None:
        fruits = where_fruits_are(view.scenery, view.state)
        return pointed_at(line, stance_of(view.state), fruits, before, view.config, config)

    aim, decided = step_aim(state.aim, now.raised and body is not None, direction, choose, now.dt_s, config)
    state = replace(state, aim=aim)
    if decided:
        state = _replaced(state, _opened(PickAsk(f"pick-{now.t_ns}", fruit=decided), now, view))
    elif decided == "" and (task := state.active) is not None:
        state = replace(state, task=task.ended(TaskStatus.CANCELLED, Reason.ASSIST_DECLINED))
    # from the first frame on: the robot's arms must not follow the hand to the head
    return state, (Reason.ASSIST_AIMING,) if aim.raised_s > 0.0 else ()


def _told(before: PickTask | None, after: PickTask | None, t_ns: int) -> list[Event]:
    """Events of what changed: preview, each stage, the end."""
    if after is None or after is before:
        return []
    told = []
    same = before is not None and before.id == after.id
    if not same and after.plan is not None:
        told.append(Event(t_ns, "assist", "assist.preview", after.fruit))
    stage = before.stage if before is not None and same else None
    if after.stage is not None and after.stage is not stage:
        told.append(Event(t_ns, "assist", f"assist.{after.stage}", after.fruit))
    if not after.active and (not same or (before is not None and before.active)):
        words = f"{after.fruit}: {after.detail}" if after.detail else after.fruit
        told.append(Event(t_ns, "assist", after.reason, words))
    return told
