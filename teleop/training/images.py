"""What the forest is grown from: padded images of the operators, and pixels drawn from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.body.features import FAR_MM, PaddedImage
from teleop.body.parts import MIRROR_PART, N_PARTS, NO_PART
from teleop.training.bodies import Bodies


@dataclass(frozen=True, slots=True, eq=False)
class Images:
    """Many padded canonical images in one array. F frames.

    flat_mm: all pixels, int16, FAR_MM off the person. part: uint8 labels, same layout. starts: (F,) int64 index of
    each image's first pixel. widths, heights: (F,). u0, v0, cx, cy, focal_px: (F,) as in PaddedImage (fx = fy).
    joints_m: (F, 20, 3). visible: (F, 20).
    """

    flat_mm: npt.NDArray[np.int16]
    part: npt.NDArray[np.uint8]
    starts: npt.NDArray[np.int64]
    widths: npt.NDArray[np.int32]
    heights: npt.NDArray[np.int32]
    u0: npt.NDArray[np.int32]
    v0: npt.NDArray[np.int32]
    cx: npt.NDArray[np.float64]
    cy: npt.NDArray[np.float64]
    focal_px: npt.NDArray[np.float64]
    joints_m: npt.NDArray[np.float64]
    visible: npt.NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.starts)


def padded(bodies: Bodies, max_offset_m: float) -> Images:
    """The images with room for feature offsets up to max_offset_m (see teleop.body.features.pad_image)."""
    pads = np.empty(len(bodies), np.int64)
    for f in range(len(bodies)):
        nearest_mm = max(int(bodies.image(f).min(initial=FAR_MM)), 1)
        pads[f] = int(np.ceil(max_offset_m * bodies.intrinsics[f, :2].max() * 1000.0 / nearest_mm)) + 1
    sizes = bodies.sizes + 2 * pads[:, None]
    starts = np.concatenate([[0], np.cumsum(sizes.prod(axis=1))])
    flat_mm, part = np.full(starts[-1], FAR_MM, np.int16), np.full(starts[-1], NO_PART, np.uint8)
    for f in range(len(bodies)):
        (width, height), pad = bodies.sizes[f], pads[f]
        inner = np.s_[pad : pad + height, pad : pad + width]
        for whole, inside in ((flat_mm, bodies.image(f)), (part, bodies.labels(f))):
            image = whole[starts[f] : starts[f + 1]].reshape(sizes[f, 1], sizes[f, 0])
            image[inner] = inside.reshape(height, width)
    return Images(
        flat_mm=flat_mm,
        part=part,
        starts=starts[:-1],
        widths=sizes[:, 0].astype(np.int32),
        heights=sizes[:, 1].astype(np.int32),
        u0=(-pads).astype(np.int32),
        v0=(-pads).astype(np.int32),
        cx=bodies.intrinsics[:, 2],
        cy=bodies.intrinsics[:, 3],
        focal_px=bodies.intrinsics[:, 0],
        joints_m=bodies.joints_m,
        visible=bodies.visible,
    )


def image_of(images: Images, f: int) -> PaddedImage:
    """One frame as the tracker sees it."""
    height, width = int(images.heights[f]), int(images.widths[f])
    flat = images.flat_mm[images.starts[f] : images.starts[f] + width * height]
    focal = float(images.focal_px[f])
    u0, v0 = int(images.u0[f]), int(images.v0[f])
    return PaddedImage(flat.reshape(height, width), u0, v0, focal, focal, float(images.cx[f]), float(images.cy[f]))


@dataclass(frozen=True, slots=True, eq=False)
class Pixels:
    """Training pixels. at: (N,) int64 index into flat_mm. frame: (N,) int32, F + f for the mirror image of frame f.
    part: (N,) uint8, mirrored there too."""

    at: npt.NDArray[np.int64]
    frame: npt.NDArray[np.int32]
    part: npt.NDArray[np.uint8]


def draw_pixels(images: Images, per_frame: int, rng: np.random.Generator, balance: float) -> Pixels:
    """Draw pixels of every frame, half of them for its mirror image.

    balance: share of the pixels drawn with equal chances for every part in the frame (class balance); the rest is
    drawn evenly over the person.
    """
    mirror = np.array([*MIRROR_PART, *range(N_PARTS, 256)], np.uint8)
    at, frame, part = [], [], []
    for f in range(len(images)):
        start = images.starts[f]
        labels = images.part[start : start + int(images.widths[f]) * int(images.heights[f])]
        body = np.flatnonzero(labels != NO_PART)
        if len(body) == 0:
            continue
        chance = np.full(len(body), (1 - balance) / len(body))
        counts = np.bincount(labels[body], minlength=N_PARTS)
        chance += balance / (counts[labels[body]] * np.count_nonzero(counts))
        chosen = body[
            np.searchsorted(np.cumsum(chance), rng.uniform(0, chance.sum(), per_frame)).clip(0, len(body) - 1)
        ]
        flipped = np.arange(per_frame) % 2 == 1
        at.append(start + chosen)
        frame.append(np.where(flipped, len(images) + f, f).astype(np.int32))
        part.append(np.where(flipped, mirror[labels[chosen]], labels[chosen]))
    return Pixels(np.concatenate(at), np.concatenate(frame), np.concatenate(part).astype(np.uint8))
