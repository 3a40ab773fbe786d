"""One control step: a frame (or none) in, a command to the robot, everything that happened out. Knows no thread."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from robot_sim.commands import RobotCommand, stop_command
from robot_sim.link.robot_link import RobotLink
from robot_sim.pick.plan import Scenery
from robot_sim.pick.surroundings import hard
from robot_sim.state import RobotState
from server.engine.filter_delay import filter_delay_s
from server.engine.ledger import Ledger
from server.engine.mailbox import Arrived
from server.engine.pending import Pending
from server.settings import Settings
from teleop.assist.step import AssistState
from teleop.assist.task import RobotView
from teleop.body.tracker import BodyTracker
from teleop.config.assist import AssistConfig
from teleop.frames import DepthFrame
from teleop.inputs import Inputs, PickAsk
from teleop.intent_types import Event, Mode
from teleop.modes import IN_CONTROL
from teleop.onsets import Onsets, step_onsets
from teleop.pipeline import Pipeline, PipelineOutput
from teleop.reasons import Reason
from teleop.recording.recorded import RecordedPose
from teleop.safety import watchdog


@dataclass(frozen=True, slots=True)
class StepContext:
    """What a step was told beside its frame and Inputs; with all three it can be done again exactly.

    now_s: the step's own time, monotonic. live, speed: of the source. estop: the robot's latch before it moved.
    """

    now_s: float
    live: bool
    speed: float
    estop: bool


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """What one step did. frame and output belong to the last frame when this step had none (``fresh`` False).

    received_s: when that frame was received, monotonic. recorded: where the robot was when it was recorded.
    """

    frame: DepthFrame | None
    output: PipelineOutput | None
    command: RobotCommand
    robot: RobotState
    inputs: Inputs
    events: tuple[Event, ...]
    received_s: float | None
    fresh: bool
    told: StepContext
    recorded: RecordedPose | None = None
    assist: AssistState = field(default_factory=AssistState)
    assist_config: AssistConfig = field(default_factory=AssistConfig)


class Core:
    """Pipeline and robot, stepped by frames and, while none come, by the clock. Used by one thread at a time."""

    def __init__(
        self,
        tracker: BodyTracker,
        world: RobotLink,
        settings: Settings,
        ledger: Ledger,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.world = world
        self.pending = Pending()
        self.look_up: Callable[[], None] = lambda: None
        """Called in the middle of a step, when tracking is done and nothing is decided: an e-stop need not wait."""
        self._tracker = tracker
        self._ledger = ledger
        self._clock = clock
        self._settings = settings
        self._pipeline = Pipeline(tracker, settings.teleop)
        self._state = self._pipeline.initial_state()
        self._last: Moment | None = None
        self._received_s: float | None = None
        self._stepped_s = clock()
        self._silence: tuple[str, ...] = ()
        self._onsets = Onsets()
        self._reset_due = False
        self._scenery = Scenery(hard(world.scenery()), world.fruits)
        self._robot = world.state()

    @property
    def assist(self) -> AssistState:
        """The assisted pick as it stands."""
        return self._state.kernel.assist

    def configure(self, settings: Settings) -> None:
        """Take a new configuration over. Perception and intent begin anew; a latched e-stop stays."""
        self._settings = settings
        self._tracker = BodyTracker(self._tracker.model, settings.teleop.body)
        self._pipeline = Pipeline(self._tracker, settings.teleop)
        self._forget()

    def forget(self, reset_robot: bool = False) -> None:
        """Begin anew with perception and intent (another source). A latched e-stop stays.

        reset_robot: the robot, too, begins from its start at the first frame, so that all can be done again exactly.
        """
        self._forget()
        self._reset_due = reset_robot

    def restart_robot(self) -> None:
        """The robot and its greenhouse begin from their start, now; the operator must engage again."""
        latched = self.world.state().estop
        self._robot = self.world.reset()
        if latched:
            self._robot = self.world.estop()
        self._forget()

    def _forget(self) -> None:
        self._state = self._pipeline.initial_state()
        self.pending = Pending(estop=self.world.state().estop, picks=self.pending.picks)
        self._last = self._received_s = None

    def estop(self) -> None:
        """Stop the robot now; the pipeline learns it at its next step."""
        self._robot = self.world.estop()
        self.pending.estop, self.pending.estop_reset = True, False

    def estop_reset(self) -> None:
        """Release the latch; the operator must engage again."""
        self._robot = self.world.estop_reset()
        self.pending.estop_reset = True

    def on_frame(self, arrived: Arrived, live: bool, speed: float) -> Moment:
        """Track, interpret, decide, move. ``speed`` is the replay's; the robot's time runs with it."""
        now_s = self._clock()
        self._ledger.add("capture", now_s - arrived.received_s)
        told = StepContext(now_s, live, speed, self.world.state().estop)
        if self._reset_due:
            self._start_robot(told)
        elif arrived.restarted and self._settings.engine.reset_robot_on_loop and not told.estop:
            self._robot = self.world.reset()
        mode = self._last.output.intent.mode if self._last and self._last.output else Mode.NO_PERSON
        if arrived.in_control and mode is Mode.SEEN:
            self.pending.engage = True  # so the robot eases to the operator of a session entered in its middle
        inputs = replace(
            self.pending.take(now_s, round(arrived.received_s * 1e9) if live else None),
            interrupted=bool(self._silence),
        )
        output = self._run(arrived.frame, inputs)
        told = replace(told, estop=self.world.state().estop)
        command = output.command
        if output.accepted:
            self._received_s, self._silence = arrived.received_s, ()
        else:
            command = self._for_refused(command, now_s)
        robot = self._move(command, told)
        self._last = Moment(
            arrived.frame,
            output,
            command,
            robot,
            inputs,
            self._told(output.events, command, robot, now_s),
            arrived.received_s,
            fresh=True,
            told=told,
            recorded=arrived.recorded,
            assist=self.assist,
            assist_config=self._pipeline.intent.assist,
        )
        return self._last

    def on_silence(self, source_failed: bool, speed: float) -> Moment:
        """A step without a frame: the last command stands until the watchdog holds, then stops.

        Direct requests (lift, disc, console) and the e-stop still count; a wish to engage waits for the next
        frame, and is refused once the watchdog misses it: nobody is seen.
        """
        now_s = self._clock()
        told = StepContext(now_s, False, speed, self.world.state().estop)
        stop = self.pending.take_stop()
        stopped = self._press(stop) if stop.estop or stop.estop_reset else ()
        last = self._last
        command = self._watched(now_s)
        if command is None and last is not None:
            command = last.command
        if command is None or source_failed:
            reason = Reason.SOURCE_FAILED if source_failed else Reason.NO_FRAME_STOP
            command = stop_command(self._t_ns, reason)
        events = self._silence_events(command)
        request, picks = None, tuple[PickAsk, ...]()
        if not events:
            # told to stand still once; from the next step on a request may move the robot
            command = replace(command, stand_still=False)
            request, picks = self.pending.take_request(now_s), self.pending.take_picks()
        missing = source_failed or self._watched(now_s) is not None
        inputs = replace(
            stop, engage=self.pending.engage and missing, request=request, picks=picks, source_failed=source_failed
        )
        self.pending.engage = self.pending.engage and not missing
        command = self._between(command, inputs)
        events = (*events, *stopped, *self._state.kernel.events)
        if inputs.engage:
            events = (*events, Event(self._t_ns, "refused", Reason.ENGAGE_NO_PERSON))
        robot = self._move(command, told)
        events = self._told(events, command, robot, now_s)
        frame, output, received_s = (last.frame, last.output, last.received_s) if last else (None, None, None)
        recorded = last.recorded if last else None
        return Moment(
            frame,
            output,
            command,
            robot,
            inputs,
            events,
            received_s,
            fresh=False,
            told=told,
            recorded=recorded,
            assist=self.assist,
            assist_config=self._pipeline.intent.assist,
        )

    def _between(self, command: RobotCommand, inputs: Inputs) -> RobotCommand:
        """Requests and the assisted pick over the command that stands while no frame comes."""
        picking = self.assist.active is not None
        mode = self._last.output.intent.mode if self._last and self._last.output else Mode.NO_PERSON
        silent = next((code for code in command.reasons if code in _SILENT), None)
        still = stopped = None
        if self.world.state().estop:
            stopped = Reason.ESTOP
        elif mode is Mode.STOPPED:
            stopped = Reason.BODY_STOP
        elif mode in IN_CONTROL and silent == Reason.NO_FRAME_HOLD:
            still = Reason.NO_FRAME_HOLD
        elif mode in IN_CONTROL and silent is not None:
            stopped = Reason(silent)
        command, self._state = self._pipeline.between(
            command, self._state, inputs, mode, still=still, stopped=stopped, robot=self._view
        )
        if picking and self._last is not None:
            # what a pick asked for counts for one step only
            held = replace(command, drive_m_s=0.0, right_arm=None, left_arm=None, lift_m=None, stand_still=False)
            self._last = replace(self._last, command=replace(held, reasons=self._last.command.reasons))
        return command

    @property
    def _t_ns(self) -> int:
        return self._last.command.t_ns if self._last else 0

    def _run(self, frame: DepthFrame, inputs: Inputs) -> PipelineOutput:
        begin_s = self._clock()
        track, state = self._pipeline.perceive(frame, self._state, inputs)
        tracked_s = self._clock()
        self.look_up()
        intent, state = self._pipeline.interpret(frame, track, state, inputs)
        command, state = self._pipeline.decide(intent, state, inputs, self._view)
        self._state = state
        self._ledger.add("tracking", tracked_s - begin_s)
        self._ledger.add("intent", self._clock() - tracked_s)
        if track.skeleton is not None:
            velocity = state.tracker.filter.velocity_m_s
            self._ledger.add("filter", filter_delay_s(velocity, self._settings.teleop.body.filter))
        return PipelineOutput(track, intent, command, (*intent.events, *state.events), state.accepted)

    def _watched(self, now_s: float) -> RobotCommand | None:
        """The watchdog's command, with the stream's time, or None while frames come."""
        received_ns = None if self._received_s is None else round(self._received_s * 1e9)
        command = watchdog(received_ns, round(now_s * 1e9), self._settings.teleop.intent.safety)
        return None if command is None else replace(command, t_ns=self._t_ns)

    def _for_refused(self, command: RobotCommand, now_s: float) -> RobotCommand:
        """What a frame that was refused leads to; the watchdog's command keeps why it was."""
        watched = self._watched(now_s)
        if watched is None:
            return command
        refused = (code for code in command.reasons if code.startswith("refused."))
        return replace(watched, reasons=(*watched.reasons, *refused))

    def _silence_events(self, command: RobotCommand) -> tuple[Event, ...]:
        """One event when the watchdog (or the source's fault) begins to stop the robot, or stops it harder."""
        stopping = tuple(code for code in command.reasons if code in _SILENT)
        if stopping == self._silence:
            return ()
        self._silence = stopping
        return tuple(Event(self._t_ns, "watchdog", code) for code in stopping)

    def _told(
        self, events: tuple[Event, ...], command: RobotCommand, robot: RobotState, now_s: float
    ) -> tuple[Event, ...]:
        """The step's events, with one for every reason of command or robot that begins now, and what the robot did."""
        events = (*events, *(Event(self._t_ns, "robot", f"robot.{e.kind}", e.subject) for e in self.world.events))
        codes = (*command.reasons, *robot.reasons)
        begun, self._onsets = step_onsets(self._onsets, codes, events, self._t_ns, now_s)
        return (*events, *begun)

    def _press(self, stop: Inputs) -> tuple[Event, ...]:
        """The e-stop, or its reset, between two frames: control and mode follow at once, the last command is void."""
        intent, self._state = self._pipeline.press(self._t_ns, self._state, stop)
        last = self._last
        if last is not None and last.output is not None:
            shown = replace(last.output.intent, mode=intent.mode, engage_progress=0.0)
            void = stop_command(self._t_ns, Reason.ESTOP if stop.estop else Reason.NOT_ENGAGED)
            self._last = replace(last, output=replace(last.output, intent=shown), command=void)
        return intent.events

    @property
    def _view(self) -> RobotView:
        """What the assisted pick knows of the robot."""
        return RobotView(self._robot, self.world.config, self._scenery)

    def _start_robot(self, told: StepContext) -> None:
        self._robot = self.world.reset()
        if told.estop:
            self._robot = self.world.estop()
            self.pending.estop = True  # what began anew must learn it again
        self._state = self._pipeline.initial_state()
        self._stepped_s, self._silence, self._reset_due = told.now_s, (), False
        self._onsets = Onsets()

    def _move(self, command: RobotCommand, told: StepContext) -> RobotState:
        # from begin of step to begin of step: how long tracking took is no part of the robot's time
        dt_s = min((told.now_s - self._stepped_s) * told.speed, self._settings.engine.max_step_s)
        self._stepped_s = told.now_s
        begin_s = self._clock()
        self._robot = self.world.step(command, dt_s)
        self._ledger.add("simulation", self._clock() - begin_s)
        return self._robot


_SILENT = frozenset({Reason.NO_FRAME_HOLD, Reason.NO_FRAME_STOP, Reason.SOURCE_FAILED})
