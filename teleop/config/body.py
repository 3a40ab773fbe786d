"""Configuration of perception: segmentation, forest, mean shift, skeleton, filter, in order of the data flow."""

from __future__ import annotations

from pydantic import Field

from teleop.config.base import Section


class FloorConfig(Section):
    """Finding the floor plane."""

    max_tilt_deg: float = Field(
        25.0, ge=0, le=60, description="largest tilt of the sensor [deg]; sensors stand within 15 deg, with reserve"
    )
    min_height_m: float = Field(0.25, ge=0, le=3, description="lowest plausible sensor height [m]")
    max_height_m: float = Field(2.6, ge=0.3, le=5, description="highest plausible sensor height [m]")
    inlier_m: float = Field(
        0.018, gt=0, le=0.2, description="distance from the plane counted as floor [m] at 2 m; grows with z^2 (noise)"
    )
    min_inliers: int = Field(250, ge=10, le=100000, description="fewest cells of the decimated cloud on a floor")
    max_error_deg: float = Field(
        0.35,
        gt=0,
        le=10,
        description="largest standard error of the floor's pitch [deg]; a thin strip of floor does not tell it",
    )
    trials: int = Field(400, ge=1, le=5000, description="RANSAC trials; 0.3 inliers give a hit with P > 0.98")
    smoothing: float = Field(0.1, gt=0, le=1, description="weight of a new plane in the running mean")


class SegmentationConfig(Section):
    """Telling the operator from the room."""

    min_depth_m: float = Field(0.5, ge=0.1, le=5, description="nearest depth used [m]; a Kinect reads from 0.5 m")
    max_depth_m: float = Field(5.0, ge=1, le=12, description="farthest depth used [m]")
    grid_columns: int = Field(160, ge=40, le=640, description="columns of the decimated grid that is labelled")
    window_m: float = Field(
        0.35,
        ge=0,
        le=5,
        description="people are looked for at least this far round the operator of the last frame [m]; the finder "
        "needs what is round a limb to know it",
    )
    window_m_s: float = Field(
        5.0, ge=0, le=50, description="and farther by this for every second since that frame [m/s]: a fast hand"
    )
    min_person: float = Field(
        0.15, ge=0, le=1, description="cells less likely to show a person are no part of the operator [1]; measured"
    )
    jump_m: float = Field(
        0.07, gt=0, le=0.5, description="depth step that parts two surfaces [m] at 2 m; grows with z^2 (quantisation)"
    )
    floor_clearance_m: float = Field(0.05, ge=0, le=0.3, description="height above the floor still taken as floor [m]")
    min_height_m: float = Field(0.55, gt=0, le=2, description="least height of the visible part of an operator [m]")
    max_height_m: float = Field(2.4, gt=0.5, le=3, description="greatest height: a tall person with raised arms [m]")
    max_width_m: float = Field(2.1, gt=0.5, le=4, description="greatest width: arms spread [m]")
    max_thickness_m: float = Field(1.5, gt=0.3, le=4, description="greatest extent in depth: arm to the sensor [m]")
    min_area_m2: float = Field(0.18, gt=0, le=2, description="least visible surface [m^2]; a slim torso with head")
    max_area_m2: float = Field(1.6, gt=0.3, le=5, description="greatest visible surface [m^2]; a wide coat")
    candidates: int = Field(3, ge=1, le=10, description="components tried as operator in a frame, likeliest first")


class ForestConfig(Section):
    """Running the forest over the operator's pixels."""

    working_focal_px: float = Field(
        285.63,
        ge=50,
        le=2000,
        description="the image is decimated to about this focal length [px]: that of the training images, 320x240",
    )
    max_pixels: int = Field(
        300, ge=200, le=400000, description="pixels evaluated at most; the stride follows from it and the person"
    )


class ProposalConfig(Section):
    """From votes to joint proposals (mean shift)."""

    max_points: int = Field(100, ge=20, le=5000, description="votes kept for a joint, the surest ones")
    starts: int = Field(2, ge=1, le=10, description="greedy starts a joint, two bandwidths apart")
    iterations: int = Field(30, ge=1, le=500, description="most mean-shift steps from a start")
    tolerance_m: float = Field(0.001, gt=0, le=0.02, description="a shorter shift ends the iteration [m]")
    spread_power: float = Field(
        2.0, ge=0, le=6, description="a vote weighs (1 + (spread / spread_scale)^2)^-power; fitted on validation frames"
    )
    spread_scale_m: float = Field(0.06, gt=0, le=1, description="spread at which a vote's weight begins to fall [m]")


class SkeletonConfig(Section):
    """Repairs between proposals and skeleton."""

    enabled: bool = Field(True, description="use bone lengths and the last frame to choose among proposals")
    min_confidence: float = Field(0.03, ge=0, le=1, description="a joint below this confidence is unknown")
    weight_power: float = Field(
        2.0, ge=0, le=10, description="how much the weight of a mode counts against bone lengths"
    )
    max_bone: float = Field(
        1.8, ge=1, le=10, description="bones longer than this share of the mean person's are wrong; the tallest has 1.2"
    )
    bone_tolerance: float = Field(
        0.35, gt=0, le=2, description="relative error of a bone length that is still believed"
    )
    previous_scale_m: float = Field(
        0.12,
        gt=0,
        le=5,
        description="distance from the last frame's joint that costs as much as a weight ratio of e [m]",
    )


class CascadeConfig(Section):
    """Networks that find people's cells and place the joints from the operator's depth image."""

    finder: bool = Field(True, description="false parts people from things by depth steps alone")
    enabled: bool = Field(True, description="false takes the forest's joints as they are")
    rounds: int = Field(
        2, ge=0, le=4, description="looks at the limbs after the coarse network, at most; the second is at the arms"
    )
    min_confidence: float = Field(
        0.3, ge=0, le=1, description="a joint less likely than this to be within 10 cm is unknown [1]"
    )


class ProportionsConfig(Section):
    """Arms as long as the rest of the body says, see teleop.body.proportions."""

    enabled: bool = Field(True, description="false leaves arms out of proportion as they are found")
    off: float = Field(
        0.08, ge=0, le=1, description="an arm is put right when a bone is longer or shorter by more than this share [1]"
    )
    tolerance: float = Field(
        0.06, gt=0, le=1, description="share by which people's bones differ from the mean at equal size [1]; measured"
    )
    sure_m: float = Field(0.04, gt=0, le=1, description="joints found this surely tell the body's size [m]")


class ElbowConfig(Section):
    """What is taken back of the elbow's mean error, see teleop.body.unbend."""

    enabled: bool = Field(True, description="false leaves the elbows where the networks place them")
    noise: float = Field(
        4.0,
        ge=0,
        le=20,
        description="variances taken from a straight arm's squared bend [1]; 2 by theory, fitted to 140 "
        "people, whose errors are larger than the networks say",
    )
    straight_deg: float = Field(
        8.0, gt=0, le=90, description="an arm bent by more is hardly straight any more [deg]; fitted"
    )
    caution: float = Field(
        6.0, ge=0, le=200, description="growth of a bend beyond the middle, times its variance [1/rad2]; fitted"
    )
    middle_deg: float = Field(
        40.0, ge=0, le=180, description="bend that hard to see forearms are drawn to [deg]; fitted"
    )
    most_spread_deg: float = Field(
        3.5,
        gt=0,
        le=45,
        description="standard deviation that counts at most [deg]: who is that unsure may be all wrong",
    )


class PersonConfig(Section):
    """Deciding whether a surface is a person."""

    min_cells: float = Field(
        0.3, ge=0, le=1, description="a surface whose cells are less likely to show a person on average is none [1]"
    )
    acquire: float = Field(0.25, ge=0, le=1, description="probability from which a surface is taken as an operator [1]")
    certain: float = Field(
        0.9, ge=0, le=1, description="probability from which the nearest is taken though another is likelier [1]"
    )
    keep: float = Field(
        0.2, ge=0, le=1, description="mean confidence of the joints below which the tracked operator is given up [1]"
    )


class BonesConfig(Section):
    """Constant bone lengths, learned per operator while they are tracked."""

    enabled: bool = Field(True, description="false leaves the joints where the networks place them")
    learn_spread_m: float = Field(
        0.015, gt=0, le=0.5, description="a bone whose ends are found this surely counts as a whole frame [m]"
    )
    memory_frames: float = Field(600.0, ge=1, le=1e6, description="frames that a learned length is the mean of")
    least_frames: float = Field(10.0, ge=1, le=1e6, description="frames before a length is used")
    tolerance_m: float = Field(0.008, gt=0, le=0.2, description="error of a learned length [m]; measured")
    sweeps: int = Field(4, ge=1, le=50, description="passes over the bones")


class FilterConfig(Section):
    """Temporal filter: jump gate and One-Euro (Casiez 2012)."""

    enabled: bool = Field(True, description="false gives single-frame results")
    min_cutoff_hz: float = Field(1.0, gt=0, le=60, description="One-Euro cutoff at rest [Hz]; measured")
    beta: float = Field(50.0, ge=0, le=100, description="One-Euro growth of the cutoff with speed [Hz per m/s]")
    derivative_cutoff_hz: float = Field(1.0, gt=0, le=60, description="One-Euro cutoff of the speed [Hz]")
    max_speed_m_s: float = Field(
        6.0, gt=0, le=50, description="faster joints are taken for errors [m/s]; a fast hand reaches 4 to 5 m/s"
    )
    gate_margin_m: float = Field(0.08, ge=0, le=1, description="jump allowed beside speed times time [m]")
    hold_s: float = Field(
        0.12, ge=0, le=5, description="a gated joint is held this long, then the jump is believed [s]"
    )


class BodyConfig(Section):
    """All of perception; its sub-sections follow the data flow."""

    floor: FloorConfig = Field(default_factory=FloorConfig)
    segmentation: SegmentationConfig = Field(default_factory=SegmentationConfig)
    forest: ForestConfig = Field(default_factory=ForestConfig)
    proposals: ProposalConfig = Field(default_factory=ProposalConfig)
    skeleton: SkeletonConfig = Field(default_factory=SkeletonConfig)
    cascade: CascadeConfig = Field(default_factory=CascadeConfig)
    proportions: ProportionsConfig = Field(default_factory=ProportionsConfig)
    elbow: ElbowConfig = Field(default_factory=ElbowConfig)
    person: PersonConfig = Field(default_factory=PersonConfig)
    bones: BonesConfig = Field(default_factory=BonesConfig)
    filter: FilterConfig = Field(default_factory=FilterConfig)
    max_gap_s: float = Field(0.5, gt=0, le=60, description="a longer gap between two frames resets the tracker [s]")
    scene_cut_m: float = Field(
        0.6, gt=0, le=10, description="an operator's centre that moves farther between frames is a cut [m]"
    )
