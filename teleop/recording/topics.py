"""The words of the recording format: topics, metadata keys, version.

Frames of reference: images, camera_info and the skeleton are in ``camera_depth_optical_frame`` (x right in the
image, y down, z forward, metres), so that overlays lie on the depth image whether it is mirrored or not.
"""

from __future__ import annotations

from typing import Final

FORMAT_VERSION: Final = 2
"""Older ones are migrated while they are read (teleop.recording.migrate)."""

DEPTH: Final = "/camera/depth/image_raw"
DEPTH_INFO: Final = "/camera/depth/camera_info"
COLOR: Final = "/camera/color/image_raw/compressed"
COLOR_INFO: Final = "/camera/color/camera_info"
JOINT_STATES: Final = "/joint_states"
TF: Final = "/tf"
TF_STATIC: Final = "/tf_static"
"""Where the colour camera is beside the depth camera."""
ROBOT_DESCRIPTION: Final = "/robot_description"
SKELETON: Final = "/teleop/skeleton"
TRACK: Final = "/teleop/track"
EVENTS: Final = "/teleop/events"
INPUTS: Final = "/teleop/inputs"

DEPTH_FRAME: Final = "camera_depth_optical_frame"
COLOR_FRAME: Final = "camera_color_optical_frame"
WORLD_FRAME: Final = "world"

DEPTH_ENCODING: Final = "16UC1"

METADATA: Final = "teleop"
"""Name of the MCAP metadata record; its keys follow."""
KEY_FORMAT: Final = "format_version"
KEY_SOFTWARE: Final = "software_version"
KEY_SOURCE: Final = "source"
KEY_CAMERA: Final = "camera"
"""JSON of the whole camera (teleop.frames.Camera): depth, mirrored, color, T_color_depth."""
KEY_COLOR_KEPT: Final = "color_kept"
"""Whether colour was recorded: "yes", "no" when it was left out for privacy, "none" when the source had none."""
KEY_SETTINGS: Final = "settings"
"""JSON of the settings that decided what the robot did: engine, teleop, robot."""
KEY_SEED: Final = "robot_seed"
KEY_MODEL: Final = "body_model_sha256"
KEY_PROCESSOR: Final = "processor"
