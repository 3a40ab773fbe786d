"""Frames for the tests of recordings."""

from __future__ import annotations

import numpy as np

from teleop.frames import Camera, DepthFrame, Intrinsics

PERIOD_NS = 33_333_333


def camera(width: int = 64, height: int = 48, *, mirrored: bool = False) -> Camera:
    return Camera(Intrinsics(57.1, 57.2, 31.9, 23.8, width, height), mirrored=mirrored)


def frames(count: int, *, cam: Camera | None = None, color: bool = False, seed: int = 0) -> list[DepthFrame]:
    """Noisy depth over the whole 16-bit range, smooth colour, 30 frames/s from 1 s on."""
    cam = cam or camera()
    rng = np.random.default_rng(seed)
    shape = (cam.depth.height, cam.depth.width)
    ramp = np.linspace(0, 200, shape[1], dtype=np.uint8)
    made = []
    for i in range(count):
        rgb = np.stack([np.tile(ramp, (shape[0], 1)), np.full(shape, i % 250), np.full(shape, 128)], axis=-1)
        made.append(
            DepthFrame(
                1_000_000_000 + i * PERIOD_NS,
                rng.integers(0, 65536, shape, dtype=np.uint16),
                cam,
                rgb.astype(np.uint8) if color else None,
                i,
            )
        )
    return made
