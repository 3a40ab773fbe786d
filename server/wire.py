"""The messages between server and console: the truth of which web/src/wire.ts is the generated twin.

Metres, degrees (angles of the person), radians (joints of the robot), seconds; skeleton space as in teleop.frames.
Numbers are finite or null: JSON knows no NaN.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field
from typing_extensions import TypeAliasType

WIRE_VERSION = 1
"""Raised when a message changes so that an older console cannot read it."""

# Named aliases, so that the generated TypeScript has the same names.
Vec2 = TypeAliasType("Vec2", tuple[float, float])
Vec3 = TypeAliasType("Vec3", tuple[float, float, float])
Vec4 = TypeAliasType("Vec4", tuple[float, float, float, float])
Pose = TypeAliasType("Pose", tuple[float, float, float, float, float, float, float])
"""x, y, z [m], quaternion x, y, z, w."""
Zone = TypeAliasType("Zone", Literal["none", "out", "forward", "work", "back", "left", "right"])
Mode = TypeAliasType(
    "Mode",
    Literal[
        "no_person",
        "seen",
        "engaged",
        "picking",
        "spraying",
        "forward",
        "back",
        "left",
        "right",
        "held",
        "stopped",
    ],
)
Hand = TypeAliasType("Hand", Literal["open", "fist", "unknown"])
Liquid = TypeAliasType("Liquid", Literal["water", "nutrient", "pesticide"])
TaskStatus = TypeAliasType(
    "TaskStatus",
    Literal["preview", "running", "succeeded", "failed", "refused", "cancelled", "taken_over"],
)
TaskStage = TypeAliasType("TaskStage", Literal["align", "approach", "clamp", "hold", "cut", "retreat", "box"])
RoleName = TypeAliasType("RoleName", Literal["viewer", "operator", "supervisor"])
ImageChoice = TypeAliasType("ImageChoice", Literal["depth", "color", "none"])


class Message(BaseModel):
    """Base of all wire types: frozen, closed, no NaN and no infinity."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class CameraInfo(Message):
    """The depth camera of the present source; lengths in pixels."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    mirrored: bool


class ZoneInfo(Message):
    """The floor map (specification, section 3), in metres."""

    depth_cuts_m: Vec4
    center_half_width_m: float
    side_limit_m: float
    hysteresis_m: float


class SceneryItem(Message):
    """One primitive of the greenhouse, in the world frame.

    size_m: box: edges along x, y, z; cylinder: radius, length along z; sphere: radius.
    """

    name: str
    kind: Literal["box", "cylinder", "sphere"]
    size_m: tuple[float, ...]
    xyz_m: Vec3
    rpy_rad: Vec3
    rgba: Vec4


class FruitInfo(Message):
    """A fruit that can be picked, as it grew: middle in the world frame, radius of a ball about it [m]. Its pieces of
    scenery are named after it."""

    name: str
    crop: Literal["cucumber", "tomato", "grape"]
    ripe: bool
    xyz_m: Vec3
    radius_m: float


class ArmJoints(Message):
    """URDF joint names of one arm."""

    c1: str
    c2: str
    elbow: str


class Hello(Message):
    """First message, and again after a change of source or configuration."""

    type: Literal["hello"] = "hello"
    version: int = WIRE_VERSION
    software: str
    joint_names: tuple[str, ...]
    bones: tuple[tuple[int, int], ...]
    camera: CameraInfo
    zones: ZoneInfo
    shoulder_step_deg: float
    T1_threshold_deg: float
    T2_threshold_deg: float
    urdf_url: str
    arm_joints: dict[Literal["right", "left", "rear"], ArmJoints]
    lift_range_m: Vec2
    disc_range_rad: Vec2
    full_tank_l: float
    scenery: tuple[SceneryItem, ...]
    fruits: tuple[FruitInfo, ...] = ()
    boot: str = ""
    """Differs from one start of the server to the next; with the id of the last event it resumes a stream."""
    missed_events: int = 0
    """Events after the one the client named that are no longer held."""


class Party(Message):
    """Somebody who is connected. id: public, derived from the secret client key."""

    id: str
    name: str
    role: RoleName


class LeaseState(Message):
    """Who may command. requests: who asks for the lease, oldest first. since: Unix time [s]."""

    holder: Party | None = None
    requests: tuple[Party, ...] = ()
    since: float | None = None


class Access(Message):
    """Who this client is and who commands: after hello and at every change. Never dropped. you: null = no access.

    by_token: the role was shown by a token or a login; else this machine has it by itself.
    """

    type: Literal["access"] = "access"
    you: Party | None
    by_token: bool = False
    holds_lease: bool = False
    lease: LeaseState = LeaseState()


class SourceState(Message):
    """What is playing. position_s counts from the first frame; duration_s is null for a live source."""

    uri: str
    kind: str
    live: bool
    paused: bool
    ended: bool
    position_s: float
    duration_s: float | None
    speed: float
    loop: bool
    fps: float
    recording: bool
    fault: str | None = None
    """Why the source gives no frames, in one line; null when it works."""


class SkeletonState(Message):
    """Joints in metres in the camera's axes, their depth-image pixels and confidence; null = unknown."""

    joints: dict[str, Vec3 | None]
    pixels: dict[str, Vec2 | None]
    confidence: dict[str, float]


class FloorState(Message):
    """The floor as the tracker sees it. pitch_deg: sensor tilted up positive, as ``teleop.intent.level.tilt_deg``."""

    camera_height_m: float
    tilt_deg: float
    pitch_deg: float = 0.0
    roll_deg: float = 0.0


class AnglesState(Message):
    """AnglesState of the operator's body in degrees, continuous; null where there is no answer."""

    theta1_right: float | None = None
    theta2_right: float | None = None
    theta3_right: float | None = None
    theta1_left: float | None = None
    theta2_left: float | None = None
    theta3_left: float | None = None
    T1: float | None = None
    T2: float | None = None


class HandsState(Message):
    """Both hands; confidence 0..1."""

    right: Hand = "unknown"
    left: Hand = "unknown"
    right_confidence: float = 0.0
    left_confidence: float = 0.0


class ArmTargetState(Message):
    """Set-points of one arm in degrees (robot_sim.commands.ArmTarget)."""

    c1_deg: float
    c2_deg: float
    elbow_deg: float


class CommandState(Message):
    """The command that reached the robot; null = hold."""

    drive_m_s: float
    turn_rad_s: float
    right_arm: ArmTargetState | None
    left_arm: ArmTargetState | None
    rear_arm: ArmTargetState | None
    lift_m: float | None
    disc_rad: float | None
    gripper_open: bool | None
    cutter_closed: bool | None
    spray_on: bool
    liquid: Liquid | None
    head_camera_sweep: bool
    reasons: tuple[str, ...]


class BasePose(Message):
    """The chassis in the world frame."""

    x: float
    y: float
    yaw: float


class RobotWire(Message):
    """What the robot reports. joints and targets: URDF joint name -> rad (m for prismatic joints).

    tank_l: liquid -> litres left. fruits: fruit that is not just hanging -> held, loose, boxed or dropped, with
    ``+damaged`` when it is bruised. moved: scenery that is no longer where hello put it.
    """

    base: BasePose
    joints: dict[str, float]
    targets: dict[str, float]
    gripper_open: bool
    cutter_closed: bool
    spray_on: bool
    liquid: Liquid
    estop: bool
    drive_m_s: float
    turn_rad_s: float
    sim_time_s: float
    reasons: tuple[str, ...]
    tank_l: dict[str, float]
    fruits: dict[str, str]
    moved: dict[str, Pose]


class Ghost(Message):
    """Where the robot was at this frame when the recording was made; joints: URDF joint name -> rad or m."""

    base: BasePose
    joints: dict[str, float]


class TaskState(Message):
    """One assisted pick. Times are Unix times [s].

    status: preview (planned, waits to be confirmed) and running are under way; succeeded, failed, refused, cancelled
    and taken_over are ends. stage: null before it runs. attended: an operator is in control, confirms with the left
    fist and keeps both hands closed. reason: code of the end; detail: what happened and what to do. forward_m: the
    drive that would bring the fruit into reach; drive_m: the one that is planned.
    """

    id: str
    kind: Literal["pick"] = "pick"
    fruit: str
    ripe: bool = True
    status: TaskStatus
    stage: TaskStage | None = None
    progress: float = Field(0.0, ge=0.0, le=1.0)
    attended: bool = False
    confirmed: bool = False
    reason: str = ""
    detail: str = ""
    drive_m: float | None = None
    forward_m: float | None = None
    created: float = 0.0
    started: float | None = None
    ended: float | None = None


class AimState(Message):
    """The operator points at a fruit (null: at none); progress 0..1 of the time that opens its preview."""

    fruit: str | None
    progress: float


class TaskPreview(Message):
    """Where an assisted pick will go: the grip point's way to the fruit, and from there to the box, in the world [m].

    Empty when nothing is planned. A newer one replaces an older one in the send queue. drive_m: the chassis first.
    """

    type: Literal["preview"] = "preview"
    task: str = ""
    fruit: str = ""
    drive_m: float = 0.0
    to_fruit: tuple[Vec3, ...] = ()
    to_box: tuple[Vec3, ...] = ()


class StageLatency(Message):
    """Milliseconds over the last few hundred frames."""

    p50: float
    p95: float
    last: float


class State(Message):
    """One frame's worth of everything. A newer one replaces an older one in the send queue. t: Unix time [s].

    ghost: only while a recording plays that knows where the robot was. task: the newest assisted pick. aim: only while
    the operator points.
    """

    type: Literal["state"] = "state"
    seq: int
    t: float
    source: SourceState | None
    skeleton: SkeletonState | None
    spine_xz: Vec2 | None
    floor: FloorState | None
    zone: Zone
    mode: Mode
    engaged: bool
    engage_progress: float
    angles: AnglesState
    hands: HandsState
    command: CommandState
    robot: RobotWire
    ghost: Ghost | None = None
    task: TaskState | None = None
    aim: AimState | None = None
    reasons: tuple[str, ...]
    latency_ms: dict[str, StageLatency]
    clients: int

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from server.client.show import state_html

        return state_html(self)


class EventMessage(Message):
    """Something that happened once, at Unix time t [s]. Never dropped on the way to a client.

    position_s: where the recording that plays was then; null for a live source. id: counts up from 1 since the start.
    """

    type: Literal["event"] = "event"
    id: int = 0
    t: float
    kind: str
    reason: str
    detail: str = ""
    position_s: float | None = None


class Coverage(Message):
    """What of the crop is wet. wet: leaf (scenery name without ``_lobe`` and ``_pair``) -> share wet with water,
    nutrient and pesticide, 0..1; dry leaves are left out. A newer one replaces an older one in the send queue."""

    type: Literal["coverage"] = "coverage"
    wet: dict[str, Vec3]


class ErrorMessage(Message):
    """Why the server refused a message of this client."""

    type: Literal["error"] = "error"
    detail: str


class Painted(Message):
    """Client: the overlay of state ``seq`` is on the screen. paint_ms: from its receipt there until then."""

    type: Literal["painted"] = "painted"
    seq: int = Field(ge=0)
    paint_ms: float | None = Field(None, ge=0, le=60_000)


class View(Message):
    """Client: which pictures it wants."""

    type: Literal["view"] = "view"
    image: ImageChoice = "depth"
    head: bool = False
    parts: bool = False


ServerMessage = Annotated[
    Hello | Access | State | EventMessage | Coverage | TaskPreview | ErrorMessage, Field(discriminator="type")
]
ClientMessage = Annotated[Painted | View, Field(discriminator="type")]
