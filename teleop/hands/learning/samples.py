"""Patches to learn from: rendered hands seen through joints as the tracker leaves them, and real crops."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from teleop.config.intent import HandConfig
from teleop.hands.aim import aim_at_hand
from teleop.hands.learning.convnet import Augment
from teleop.hands.legible import illegible
from teleop.hands.network import LAYERS_OF, Sight
from teleop.hands.patch import BRIGHTNESS, SIZE, Patch, hand_depth_m, hand_patch
from teleop.hands.skin_model import SkinModel, chroma, generic_skin
from teleop.people.hand_shots import HandShot
from teleop.skeleton import Skeleton

DRAWS: Final = 3
"""Noisy copies of the joints per hand."""
JOINT_NOISE_M: Final = (0.010, 0.018, 0.030)
_FACE_LIGHT: Final = 0.8
"""How bright a face is on average under the renderer's lamp and sky."""


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """patches: (N, draws, SIZE, SIZE, layers) float16. openness: (N,), 1 for an open hand, 0 for a fist."""

    patches: npt.NDArray[np.float16]
    openness: npt.NDArray[np.float32]


HALF_OPEN: Final = (0.25, 0.75)
"""Up to this curl a hand is as good as open, from that on as good as a fist; between them neither answer is right."""


def openness(curl: float) -> float:
    """What the network is to answer: 1 open .. 0 fist; a hand half closed is half open, so it is left undecided."""
    low, high = HALF_OPEN
    return min(1.0, max(0.0, (high - curl) / (high - low)))


def skin_of(shot: HandShot, rng: np.random.Generator, config: HandConfig) -> SkinModel:
    """What a face would have taught about this skin, with its error; sometimes no face was seen."""
    if rng.uniform() < 0.15:
        return generic_skin(config)
    lit = np.clip(_FACE_LIGHT * shot.skin_rgb, 0, 255).astype(np.uint8)
    cb, cr = chroma(lit.reshape(1, 1, 3))[0, 0] + rng.normal(0, 2.5, 2)
    a, c = rng.uniform(10, 45, 2)
    return SkinModel((float(cb), float(cr)), (float(a), float(-0.4 * np.sqrt(a * c)), float(c)), 1.0)


def drawn(shot: HandShot, rng: np.random.Generator, config: HandConfig) -> Patch | None:
    """The patch of one hand under noisy joints; None when no reading can come of it."""
    noise = rng.normal(0, rng.choice(JOINT_NOISE_M), (20, 3))
    skeleton = Skeleton(0, shot.joints_m + noise, np.ones(20))
    aim = aim_at_hand(skeleton, shot.side, shot.frame.camera)
    if aim is None or illegible(shot.frame, aim, config) is not None:
        return None
    z_m = hand_depth_m(shot.frame, aim, config)
    return None if z_m is None else hand_patch(shot.frame, aim, z_m, skin_of(shot, rng, config))


def collect(shots: Iterable[HandShot], config: HandConfig, seed: int, draws: int = DRAWS) -> Samples:
    """Patches of all shots that can be read; every hand gives ``draws`` of them."""
    rng = np.random.default_rng(seed)
    patches, answers = [], []
    for shot in shots:
        own = [p for p in (drawn(shot, rng, config) for _ in range(3 * draws)) if p is not None][:draws]
        if len(own) == draws:
            patches.append(np.stack(own).astype(np.float16))
            answers.append(openness(shot.curl))
    return Samples(np.stack(patches), np.array(answers, np.float32))


def augmenter(sight: Sight) -> Augment:
    """What cameras and trackers may do besides, for patches of one network: see ``_augmented``."""
    layers = LAYERS_OF[sight]
    bright = layers.index(BRIGHTNESS) if BRIGHTNESS in layers else None

    def augment(x: Patch, rng: np.random.Generator) -> Patch:
        return _augmented(x, rng, bright)

    return augment


def _augmented(x: Patch, rng: np.random.Generator, bright: int | None) -> Patch:
    """Flips, shifts, turns and changes of size; where a layer is brightness, changes of light and noise."""
    out = np.empty_like(x)
    for i, patch in enumerate(x):
        angle, scale = rng.normal(0, 9), np.exp(rng.normal(0, 0.10))
        M = cv2.getRotationMatrix2D(((SIZE - 1) / 2, (SIZE - 1) / 2), angle, scale)
        M = np.asarray(M, np.float64)
        M[:, 2] = M[:, 2] + rng.normal(0, 1.5, 2)
        warped = cv2.warpAffine(patch, M, (SIZE, SIZE), flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        out[i] = warped[:, ::-1] if rng.uniform() < 0.3 else warped
    if bright is not None:
        gain, shift = rng.uniform(0.6, 1.4, (len(x), 1, 1)), rng.normal(0, 0.08, (len(x), 1, 1))
        noise = rng.normal(0, 0.05, out.shape[:-1])
        out[..., bright] = (out[..., bright] * gain + shift + noise).astype(np.float32)
    return out
