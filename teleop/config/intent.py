"""Configuration of intent and safety: zones, task, mapping, hands, engaging, watchdogs.

"spec" is the teleoperation specification; "source" the paper behind it, with its equation numbers.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from annotated_types import Len
from pydantic import Field, model_validator

from teleop.config.assist import AssistConfig
from teleop.config.base import Section


class LevelConfig(Section):
    """How camera axes become floor-levelled axes."""

    level: Literal["on", "off"] = Field(
        default="on", description="levelled joints for zones and angles; off is the source's way"
    )
    tilt_deg: float = Field(
        default=0.0,
        ge=-45.0,
        le=45.0,
        description="sensor tilt, up positive, used when no floor is seen [deg]; calibration",
    )
    jump_deg: float = Field(
        default=2.0,
        ge=0.2,
        le=45.0,
        description="a floor that tilts by more in a frame is doubted [deg]; ours",
    )
    settle_s: float = Field(
        default=0.5, ge=0.0, le=10.0, description="another floor must stay this long to be believed [s]; ours"
    )


class ZoneConfig(Section):
    """The 2x4 threshold matrix T (5), as the lengths l1..l8 it is made of, and how a zone is entered and left."""

    l1_m: float = Field(
        default=1.4, ge=0.4, le=5.0, description="depth of the range nearer than all zones [m]; spec section 3"
    )
    l2_m: float = Field(default=0.5, ge=0.1, le=5.0, description="depth of the forward zone [m]; spec section 3")
    l3_m: float = Field(default=0.9, ge=0.1, le=5.0, description="depth of the working zone [m]; spec section 3")
    l4_m: float = Field(default=0.6, ge=0.1, le=5.0, description="depth of the backward zone [m]; spec section 3")
    l5_m: float = Field(default=0.5, ge=0.1, le=5.0, description="width of the left zone [m]; spec section 3")
    l6_m: float = Field(default=0.8, ge=0.1, le=5.0, description="width of the centre, T(2,2) [m]; spec section 3")
    l7_m: float = Field(default=0.5, ge=0.1, le=5.0, description="width of the right zone [m]; spec section 3")
    l8_m: float = Field(default=0.0, ge=0.0, le=0.0, description="fourth width, unused [m]; spec section 3")
    margin_m: float = Field(
        default=0.05,
        ge=0.0,
        le=0.2,
        description="how far outside a zone its occupant must be to leave it [m]; > 4 sigma of joint noise",
    )
    dwell_s: float = Field(
        default=0.1, ge=0.0, le=3.0, description="time in a new zone before it counts [s]; ours: two frames at 15 Hz"
    )
    out_dwell_s: float = Field(
        default=0.04, ge=0.0, le=1.0, description="the same for leaving all zones, which stops [s]; ours: two frames"
    )

    @model_validator(mode="after")
    def _margins_fit(self) -> Self:
        narrowest = min(self.l2_m, self.l3_m, self.l4_m, self.l5_m, self.l6_m, self.l7_m)
        if 2 * self.margin_m >= narrowest:
            raise ValueError(
                f"margin_m must be below half the narrowest zone ({narrowest / 2:g} m), got {self.margin_m:g}"
            )
        return self


class TaskConfig(Section):
    """Leg features that select the task, with Page's test instead of a bare threshold."""

    T1_deg: float = Field(
        default=12.0, ge=1.0, le=60.0, description="legs further apart: picking [deg]; source, eq. (8)"
    )
    T2_deg: float = Field(
        default=14.0, ge=1.0, le=60.0, description="one leg forward: head camera turns [deg]; source, eq. (11)"
    )
    still_m_s: float = Field(
        default=0.35,
        ge=0.05,
        le=5.0,
        description="legs of a spine faster than this are walking: no evidence [m/s]; ours",
    )
    ahead_m_s: float = Field(
        default=1.2,
        ge=0.05,
        le=5.0,
        description="the same for T1 and a spine that comes nearer or goes away, which hardly spreads legs [m/s]; ours",
    )
    gait_smoothing_s: float = Field(
        default=0.1,
        ge=0.02,
        le=2.0,
        description="time constant of the spine's speed [s]; ours: 20 mm RMS of noise reads as less than 0.2 m/s",
    )
    T2_hold_s: float = Field(default=4.0, ge=0.0, le=30.0, description="how long T2 must be exceeded [s]; source")
    margin_deg: float = Field(
        default=2.5, ge=0.0, le=10.0, description="deviation beyond the threshold that is no evidence yet [deg]; ours"
    )
    evidence_deg_s: float = Field(
        default=0.9,
        ge=0.0,
        le=20.0,
        description="accumulated deviation that decides [deg s]; zero flips at 20 mm RMS noise",
    )
    noise_deg: float = Field(
        default=3.0, ge=0.0, le=45.0, description="noise of the angles for which that is asked [deg]; 20 mm RMS"
    )
    quiet: float = Field(
        default=0.2, gt=0.0, le=1.0, description="share of it that is asked of angles without noise [1]; ours"
    )
    noise_memory_s: float = Field(
        default=0.5, ge=0.05, le=10.0, description="the noise is a mean over about so long [s]; ours"
    )
    clip_deg: float = Field(
        default=15.0, ge=1.0, le=90.0, description="largest deviation counted in one frame [deg]; outliers"
    )


class AngleConfig(Section):
    """When an angle has no answer."""

    min_projection: float = Field(
        default=0.25,
        ge=0.01,
        le=0.9,
        description="shortest usable projection, as a part of the bone's length [1]; ours",
    )
    min_bone_m: float = Field(default=0.05, ge=0.0, le=0.5, description="shortest bone that has a direction [m]; ours")


class BoneConfig(Section):
    """Expected lengths of bones: of the operator where a profile tells, else of a person of 1.75 m."""

    upper_arm_m: float = Field(
        default=0.325, ge=0.1, le=1.2, description="shoulder to elbow [m]; 0.186 of the height, Winter 1990"
    )
    forearm_m: float = Field(
        default=0.255, ge=0.1, le=1.2, description="elbow to wrist [m]; 0.146 of the height, Winter 1990"
    )
    trunk_m: float = Field(
        default=0.53, ge=0.1, le=1.2, description="hip centre to shoulder centre [m]; 0.30 of the height, Winter 1990"
    )
    thigh_m: float = Field(default=0.43, ge=0.1, le=1.2, description="hip to knee [m]; 0.245 of height, Winter 1990")
    shin_m: float = Field(default=0.43, ge=0.1, le=1.2, description="knee to ankle [m]; 0.246 of height, Winter 1990")
    tolerance: float = Field(
        default=0.5, ge=0.1, le=2.0, description="a bone further off is refused, as a part of its length [1]; ours"
    )


class MappingConfig(Section):
    """From arm angles to servo set-points."""

    mapping: Literal["paper", "direction"] = Field(
        default="paper", description="paper: eq. (14)-(21); direction: C1, C2 solved"
    )
    handedness: Literal["right", "left"] = Field(
        default="right", description="left swaps the roles of the operator's arms and hands"
    )
    step_deg: float = Field(default=15.0, ge=1.0, le=45.0, description="step of the shoulder set-points [deg]; source")
    shoulder_max_deg: float = Field(
        default=90.0, ge=15.0, le=180.0, description="largest shoulder set-point [deg]; source"
    )
    elbow_min_deg: float = Field(default=90.0, ge=0.0, le=170.0, description="smallest elbow set-point [deg]; source")
    margin_deg: float = Field(
        default=2.0, ge=0.0, le=7.0, description="deviation beyond a bin's edge that is no evidence yet [deg]; ours"
    )
    evidence_deg_s: float = Field(
        default=1.3,
        ge=0.0,
        le=20.0,
        description="accumulated deviation that changes the bin [deg s]; zero flips at 20 mm RMS noise",
    )
    clip_deg: float = Field(
        default=20.0, ge=1.0, le=180.0, description="largest deviation counted in one frame [deg]; outliers"
    )
    min_confidence: float = Field(
        default=0.2, ge=0.0, le=1.0, description="joints below it do not move an arm [1]; ours"
    )
    direction_deadband_deg: float = Field(
        default=2.0, ge=0.0, le=15.0, description="mapping direction: smaller changes are not sent [deg]; ours"
    )
    min_facing_m: float = Field(
        default=0.08,
        ge=-1.0,
        le=0.5,
        description="right shoulder at least this far right of the left one, else the arms hold [m]; ours",
    )
    hanging_deg: float = Field(
        default=25.0, ge=0.0, le=90.0, description="an upper arm nearer to straight down may be hanging [deg]; ours"
    )
    hanging_elbow_deg: float = Field(
        default=150.0, ge=90.0, le=180.0, description="a straighter elbow than this, too: it hangs [deg]; ours"
    )
    ease_step_s: float = Field(
        default=0.3, ge=0.0, le=3.0, description="least time between shoulder steps while easing in [s]; 50 deg/s"
    )
    ease_elbow_deg_s: float = Field(
        default=60.0, ge=1.0, le=720.0, description="elbow speed while easing in [deg/s]; ours"
    )
    disc_half_turn_s: float = Field(
        default=2.0, ge=0.1, le=30.0, description="arms locked this long per half turn [s]; spec section 6"
    )


class DriveConfig(Section):
    """Speeds of the cruising modes."""

    forward_m_s: float = Field(default=0.3, ge=0.0, le=2.0, description="chassis speed in the forward zone [m/s]; ours")
    back_m_s: float = Field(default=0.2, ge=0.0, le=2.0, description="chassis speed in the backward zone [m/s]; ours")
    turn_rad_s: float = Field(default=0.35, ge=0.0, le=3.0, description="turning rate in the side zones [rad/s]; ours")


class HandConfig(Section):
    """Open hand or fist."""

    hand: Literal["shape", "paper"] = Field(
        default="shape", description="paper: skin ratio in a fixed crop; shape: colour and depth"
    )
    crop_px: int = Field(
        default=50, ge=10, le=200, description="side of the paper crop in a 640x480 image [px]; source"
    )
    cb_min: int = Field(default=77, ge=0, le=255, description="skin range, Cb from; source, eq. (22)")
    cb_max: int = Field(default=127, ge=0, le=255, description="skin range, Cb to; source, eq. (22)")
    cr_min: int = Field(default=133, ge=0, le=255, description="skin range, Cr from; source, eq. (23)")
    cr_max: int = Field(default=173, ge=0, le=255, description="skin range, Cr to; source, eq. (23)")
    ratio: float = Field(
        default=0.33,
        ge=0.0,
        le=1.0,
        description="skin area over crop area above which a hand is open [1]; measured; source: 0.8",
    )
    depth_gate_m: float = Field(
        default=0.08, ge=0.02, le=0.3, description="pixels this near the hand's depth belong to it [m]; research"
    )
    min_pixels: int = Field(default=40, ge=5, le=5000, description="fewer hand pixels are no answer [px]; ours")
    max_ray_cos: float = Field(
        default=0.93, ge=0.0, le=1.0, description="forearm along the ray beyond this cosine: unknown [1]; 22 deg"
    )
    min_confidence: float = Field(default=0.2, ge=0.0, le=1.0, description="hand joints below it: unknown [1]; ours")
    decide_margin: float = Field(
        default=1.0, ge=0.0, le=10.0, description="log odds nearer zero than this: unknown [1]; 73 %, rendered hands"
    )
    skin: Annotated[tuple[float, ...], Len(5, 5)] | None = Field(
        default=None,
        description="the operator's skin: mean Cb, mean Cr, variance of Cb, covariance, variance of Cr; from a profile",
    )
    skin_frames: int = Field(
        default=60, ge=1, le=10_000, description="frames over which the operator's skin colour is averaged [1]; ours"
    )
    debounce_s: float = Field(
        default=0.12, ge=0.0, le=2.0, description="a new state must last this long [s]; 3-5 frames, research"
    )
    unknown_s: float = Field(default=0.4, ge=0.0, le=5.0, description="no answer for this long: unknown [s]; ours")

    @model_validator(mode="after")
    def _ranges_are_ranges(self) -> Self:
        if self.cb_min > self.cb_max or self.cr_min > self.cr_max:
            raise ValueError("skin range: cb_min <= cb_max and cr_min <= cr_max must hold")
        if self.skin is not None:
            cb, cr, a, b, c = self.skin
            if not (0 <= cb <= 255 and 0 <= cr <= 255 and a > 0 and c > 0 and a * c > b * b):
                raise ValueError("skin: means must lie in 0..255 and the variances must form a positive matrix")
        return self


class EngageConfig(Section):
    """Gestures that engage, disengage and stop."""

    hold_s: float = Field(
        default=1.0, ge=0.1, le=10.0, description="hands beside the head this long [s]; spec section 3"
    )
    release_s: float = Field(default=0.4, ge=0.0, le=5.0, description="pause before the gesture counts again [s]; ours")
    leak: float = Field(
        default=2.0,
        ge=0.5,
        le=20.0,
        description="a gesture that breaks off runs back this many times faster than it grew [1]; ours: one bad frame "
        "does not end it",
    )
    beside_min_m: float = Field(
        default=0.10, ge=0.0, le=0.5, description="least sideways distance of hand and head [m]; half a head"
    )
    beside_max_m: float = Field(
        default=0.60, ge=0.2, le=1.2, description="largest sideways distance of hand and head [m]; ours"
    )
    below_head_m: float = Field(
        default=0.25, ge=0.0, le=1.0, description="hand at most this far below the head's centre [m]; ours"
    )
    above_head_m: float = Field(
        default=0.35, ge=0.0, le=1.0, description="hand at most this far above the head's centre [m]; ours"
    )
    elbow_bent_deg: float = Field(
        default=130.0, ge=30.0, le=180.0, description="elbow angle below which it is bent [deg]; ours"
    )
    crossed_s: float = Field(
        default=0.3, ge=0.05, le=5.0, description="forearms crossed this long stop everything [s]; spec section 3"
    )
    crossed_m: float = Field(
        default=0.04, ge=0.0, le=0.5, description="how far the wrists must have passed each other [m]; ours"
    )
    crossed_far_m: float = Field(
        default=0.08,
        ge=0.0,
        le=0.5,
        description="wrists that have passed each other by so much are crossed wherever the elbows, which folded arms "
        "hide, are taken to be [m]; ours",
    )
    hold_progress: float = Field(
        default=0.05, ge=0.0, le=1.0, description="the arms hold once the gesture has come this far [1]; ours"
    )


class SafetyConfig(Section):
    """Watchdogs, frame checks, jump rejection."""

    no_frame_hold_s: float = Field(
        default=0.2, ge=0.05, le=5.0, description="no frame received for this long: hold [s]; spec"
    )
    no_frame_stop_s: float = Field(
        default=0.5, ge=0.05, le=10.0, description="no frame received for this long: stop [s]; spec"
    )
    lost_hold_s: float = Field(
        default=0.3, ge=0.0, le=5.0, description="operator not tracked for this long: hold [s]; spec"
    )
    lost_disengage_s: float = Field(
        default=2.0, ge=0.1, le=60.0, description="operator not tracked for this long: disengaged [s]; ours"
    )
    max_dt_s: float = Field(
        default=0.15,
        ge=0.02,
        le=1.0,
        description="a frame counts for no longer than this in dwells, gestures, evidence [s]; a gap proves nothing",
    )
    restart_s: float = Field(
        default=1.0,
        ge=0.1,
        le=60.0,
        description="a stamp this far back, or a gap this long, starts the stream anew [s]; ours",
    )
    stale_s: float = Field(
        default=0.5, ge=0.05, le=10.0, description="frames later than usual by this are refused [s]; spec"
    )
    clock_drift_ppm: float = Field(
        default=200.0, ge=0.0, le=10_000.0, description="drift allowed between sensor and host clocks [1e-6]; ours"
    )
    future_s: float = Field(
        default=0.5, ge=0.05, le=10.0, description="frames stamped ahead by this are refused [s]; ours"
    )
    frozen_s: float = Field(
        default=0.2,
        ge=0.02,
        le=10.0,
        description="the very same picture for this long is no picture [s]; ours: a sensor's noise never repeats",
    )
    joint_speed_m_s: float = Field(
        default=8.0, ge=1.0, le=50.0, description="no joint moves faster [m/s]; a thrown punch is 8"
    )
    joint_slack_m: float = Field(
        default=0.12, ge=0.0, le=1.0, description="jump that noise may make [m]; research: 12 cm a frame"
    )
    trunk_speed_m_s: float = Field(
        default=3.0, ge=0.5, le=20.0, description="no operator's trunk moves faster [m/s]; a run"
    )
    max_range_m: float = Field(
        default=10.0, ge=2.0, le=50.0, description="joints farther than this are refused [m]; sensor range"
    )

    @model_validator(mode="after")
    def _order(self) -> Self:
        if self.no_frame_stop_s < self.no_frame_hold_s:
            raise ValueError(f"no_frame_stop_s must be at least no_frame_hold_s ({self.no_frame_hold_s:g} s)")
        if self.lost_disengage_s < self.lost_hold_s:
            raise ValueError(f"lost_disengage_s must be at least lost_hold_s ({self.lost_hold_s:g} s)")
        return self


class IntentConfig(Section):
    """All of intent; its sub-sections follow the data flow."""

    level: LevelConfig = Field(default_factory=LevelConfig)
    zones: ZoneConfig = Field(default_factory=ZoneConfig)
    task: TaskConfig = Field(default_factory=TaskConfig)
    angles: AngleConfig = Field(default_factory=AngleConfig)
    bones: BoneConfig = Field(default_factory=BoneConfig)
    hands: HandConfig = Field(default_factory=HandConfig)
    engage: EngageConfig = Field(default_factory=EngageConfig)
    mapping: MappingConfig = Field(default_factory=MappingConfig)
    drive: DriveConfig = Field(default_factory=DriveConfig)
    safety: SafetyConfig = Field(default_factory=SafetyConfig)
    assist: AssistConfig = Field(default_factory=AssistConfig)
