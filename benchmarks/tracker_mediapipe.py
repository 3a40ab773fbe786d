"""Runs in the environment of MediaPipe, not in ours: colour images in, landmarks and times out.

``python tracker_mediapipe.py IMAGES OUT``: IMAGES an .npz of ``color`` (F, H, W, 3) uint8 RGB and ``run``
(F,), OUT an .npz of ``seconds`` (F,), ``world_m`` (F, 33, 3) and ``score`` (F, 33), NaN where nobody is found.
"""

from __future__ import annotations

import sys
import time

import mediapipe as mp
import numpy as np


def main(images: str, out: str) -> None:
    """Track every run of images with MediaPipe Pose in its tracking mode."""
    with np.load(images) as data:
        color, run = data["color"], data["run"]
    seconds, world, score = np.zeros(len(run)), np.full((len(run), 33, 3), np.nan), np.full((len(run), 33), np.nan)
    pose = None
    for f, number in enumerate(run):
        if f == 0 or number != run[f - 1]:
            if pose is not None:
                pose.close()
            pose = mp.solutions.pose.Pose(static_image_mode=False, model_complexity=1, smooth_landmarks=True)
            pose.process(color[f])  # loads the graph; not timed
        start = time.perf_counter()
        answer = pose.process(color[f])
        seconds[f] = time.perf_counter() - start
        if answer.pose_world_landmarks is not None:
            marks = answer.pose_world_landmarks.landmark
            world[f] = [(m.x, m.y, m.z) for m in marks]
            score[f] = [m.visibility for m in marks]
    np.savez(out, seconds=seconds, world_m=world, score=score)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
