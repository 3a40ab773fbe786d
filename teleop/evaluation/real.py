"""The real recordings with another tracker's joints beside them (data set kinect_real). Never trained on."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from teleop.data import data_folder
from teleop.errors import DataError
from teleop.frames import Camera, DepthFrame, Intrinsics
from teleop.joints import JOINT_INDEX, JOINT_NAMES, N_JOINTS

FRAMES: Final = 2227
"""Frames of the data set."""
UPPER_BODY: Final = tuple(
    JOINT_INDEX[n] for n in JOINT_NAMES if n.startswith(("head", "shoulder", "elbow", "wrist", "hand", "spine"))
)


@dataclass(frozen=True, slots=True, eq=False)
class RealFrame:
    """A frame with the other tracker's joints (20, 3), which of them agree with the depth image, and whose they are."""

    frame: DepthFrame
    joints_m: npt.NDArray[np.float64]
    trusted: npt.NDArray[np.bool_]
    subject: int
    first: bool


def load_real(every: int = 1) -> list[RealFrame]:
    """Every ``every``-th frame. Raises DataError when the data set is missing or broken."""
    folder = data_folder("kinect_real")
    spec = json.loads((folder / "camera.json").read_text())
    intrinsics = Intrinsics(**{k: spec[k] for k in ("fx", "fy", "cx", "cy", "width", "height")})
    camera = Camera(intrinsics, bool(spec["mirrored"]))
    lines = [line.split() for line in (folder / "depth.txt").read_text().splitlines() if line and line[0] != "#"]
    truths = [json.loads(line) for line in (folder / "truth.jsonl").read_text().splitlines()]
    if len(lines) != len(truths):
        raise DataError(f"'{folder}' has {len(lines)} images but {len(truths)} truths; fetch the data set anew")
    out = []
    for (time_s, name), truth in list(zip(lines, truths, strict=True))[::every]:
        depth = cv2.imread(str(folder / name), cv2.IMREAD_UNCHANGED)
        if depth is None:
            raise DataError(f"image '{folder / name}' cannot be read; fetch the data set anew")
        joints, trusted = np.full((N_JOINTS, 3), np.nan), np.zeros(N_JOINTS, bool)
        for joint, position in truth["joints"].items():
            joints[JOINT_INDEX[joint]] = position
        for joint in truth["trusted"]:
            trusted[JOINT_INDEX[joint]] = True
        frame = DepthFrame(round(float(time_s) * 1e9), np.asarray(depth, np.uint16), camera)
        out.append(RealFrame(frame, joints, trusted, int(truth["subject"]), bool(truth["first"])))
    return out
