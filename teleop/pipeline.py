"""The whole way from a depth frame to a robot command, as one pure step.

``step`` is ``perceive``, ``interpret``, ``decide`` in that order; whoever wants to time the stages calls them one by
one. No clock, no file, no socket: the same frames and inputs give the same commands, always.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from robot_sim.commands import RobotCommand
from teleop.assist.step import Situation
from teleop.assist.task import RobotView
from teleop.body.tracker import BodyTracker, TrackerState
from teleop.config import TeleopConfig
from teleop.control import Control
from teleop.frames import DepthFrame
from teleop.hands.reader import read_hands
from teleop.inputs import Inputs, RobotRequest
from teleop.intent import Circumstances, HandReader, IntentState, interpret, settled_hands
from teleop.intent_types import Event, Intent, Mode
from teleop.kernel import step_between, step_kernel
from teleop.kernel_state import KernelState, Moment
from teleop.reasons import Reason
from teleop.safety import PictureState, StreamState, step_picture, step_stream
from teleop.skeleton import Track
from teleop.work import swapped

__all__ = ["Inputs", "Pipeline", "PipelineOutput", "PipelineState", "RobotRequest"]


@dataclass(frozen=True, slots=True, eq=False)
class PipelineState:
    """Everything the pipeline remembers between two frames."""

    tracker: TrackerState
    stream: StreamState = field(default_factory=StreamState)
    intent: IntentState = field(default_factory=IntentState)
    kernel: KernelState = field(default_factory=KernelState)
    picture: PictureState = field(default_factory=PictureState)

    @property
    def accepted(self) -> bool:
        """Whether the last frame brought something new; only such a frame feeds the watchdog."""
        return self.stream.refused is None and self.picture.refused is None

    @property
    def events(self) -> tuple[Event, ...]:
        """Events of the kernel at the last step (tools, refused requests); intent has its own."""
        return self.kernel.events


@dataclass(frozen=True, slots=True, eq=False)
class PipelineOutput:
    """One frame's results, one field per arrow of the data flow. events: of intent and kernel together."""

    track: Track
    intent: Intent
    command: RobotCommand
    events: tuple[Event, ...] = ()
    accepted: bool = True


class Pipeline:
    """Perception, intent and safety with one configuration; holds no state of its own."""

    def __init__(self, tracker: BodyTracker, config: TeleopConfig, hands: HandReader = read_hands) -> None:
        """hands: the rule that reads them, one frame at a time. The chosen operator's values count."""
        self.tracker = tracker
        self.config = config
        self.intent = config.effective_intent()
        self.hands = hands

    def initial_state(self, assume_engaged: bool = False) -> PipelineState:
        """Nobody seen, nothing commanded. assume_engaged: whoever is seen is in control (offline tracking)."""
        intent = IntentState(control=Control(assumed=assume_engaged))
        return PipelineState(tracker=self.tracker.initial_state(), intent=intent)

    def step(
        self, frame: DepthFrame, state: PipelineState, inputs: Inputs = Inputs(), robot: RobotView | None = None
    ) -> tuple[PipelineOutput, PipelineState]:
        """One frame through all stages. robot: for the assisted pick, where there is one."""
        track, state = self.perceive(frame, state, inputs)
        intent, state = self.interpret(frame, track, state, inputs)
        command, state = self.decide(intent, state, inputs, robot)
        return PipelineOutput(track, intent, command, (*intent.events, *state.events), state.accepted), state

    def perceive(
        self, frame: DepthFrame, state: PipelineState, inputs: Inputs = Inputs()
    ) -> tuple[Track, PipelineState]:
        """Judge the frame's stamp and picture, then track. A frame that is not used gives an empty track."""
        stream = step_stream(state.stream, frame.t_ns, inputs.receive_t_ns, self.intent.safety)
        picture = state.picture
        if stream.refused is None:
            picture = step_picture(picture, frame, stream.dt_s, self.intent.safety)
        tracker = self.tracker.initial_state() if stream.restarted else state.tracker
        if stream.refused is not None or picture.refused is not None:
            track = Track(frame.t_ns, None, None, None, None, None)
        else:
            track, tracker = self.tracker.step(frame, tracker)
        return track, replace(state, tracker=tracker, stream=stream, picture=picture)

    def interpret(
        self, frame: DepthFrame, track: Track, state: PipelineState, inputs: Inputs = Inputs()
    ) -> tuple[Intent, PipelineState]:
        """What the operator wants: zone, mode, angles, hands."""
        stream = state.stream
        refused = stream.refused or state.picture.refused
        reasons = () if refused is None else (refused,)
        if inputs.source_failed:
            reasons = (*reasons, Reason.SOURCE_FAILED)
        now = Circumstances(
            t_ns=frame.t_ns if stream.last_t_ns is None else stream.last_t_ns,
            dt_s=stream.dt_s,
            used=stream.refused is None,
            restarted=stream.restarted,
            reasons=reasons,
        )
        intent, after = interpret(frame, track, state.intent, inputs, now, self.intent, self.hands)
        return intent, replace(state, intent=after)

    def press(self, t_ns: int, state: PipelineState, inputs: Inputs) -> tuple[Intent, PipelineState]:
        """A step without a frame: the buttons alone, so that a stop counts while none comes."""
        now = Circumstances(t_ns=t_ns, dt_s=0.0, used=False, restarted=False)
        intent, after = interpret(None, None, state.intent, inputs, now, self.intent)
        return intent, replace(state, intent=after)

    def between(
        self,
        command: RobotCommand,
        state: PipelineState,
        inputs: Inputs,
        mode: Mode,
        *,
        still: Reason | None,
        stopped: Reason | None,
        robot: RobotView | None,
    ) -> tuple[RobotCommand, PipelineState]:
        """A step without a frame: requests and the assisted pick, over the command that stands.

        mode: as it stands. still: why the operator cannot be followed now. stopped: why the robot must not move.
        """
        hands, sight = settled_hands(state.intent), state.intent.sight
        left_handed = self.intent.mapping.handedness == "left"
        now = Situation(
            command.t_ns,
            mode,
            swapped(hands) if left_handed else hands,
            sight.body if sight.seen_now else None,
            still=still,
            stopped=stopped,
            manual=inputs.request is not None,
        )
        command, kernel = step_between(command, state.kernel, now, inputs.request, inputs.picks, robot, self.intent)
        return command, replace(state, kernel=kernel)

    def decide(
        self, intent: Intent, state: PipelineState, inputs: Inputs = Inputs(), robot: RobotView | None = None
    ) -> tuple[RobotCommand, PipelineState]:
        """What the robot is told: limited, or held with a reason. robot: for the assisted pick."""
        sight = state.intent.sight
        moment = Moment(
            body=sight.body if sight.seen_now else None,
            dt_s=min(state.stream.dt_s, self.intent.safety.max_dt_s),
            zone_settled=state.intent.zone.settled,
            estop=state.intent.control.estop,
            head_camera_sweep=state.intent.task.head_camera_sweep,
            robot=robot,
            interrupted=inputs.interrupted,
            crossing=state.intent.gestures.crossed_s > 0.0,
        )
        command, kernel = step_kernel(intent, moment, state.kernel, inputs.request, self.intent, inputs.picks)
        return command, replace(state, kernel=kernel)
