"""The operator's skin: learned from a face with hair in it, remembered, told from a wall."""

import numpy as np
import pytest
from stick_figure import Person, skeleton

from teleop.config.intent import HandConfig
from teleop.frames import Camera, DepthFrame, kinect_v1, pixels
from teleop.hands.skin_model import (
    SkinModel,
    chroma,
    face_skin,
    fit_skin,
    generic_skin,
    likelihood,
    remembered,
    step_skin,
    stored_skin,
)

CONFIG = HandConfig()
LIGHT, DARK, HAIR, WALL = (224, 172, 138), (96, 62, 44), (30, 26, 24), (60, 90, 160)


def cb_cr(rgb: tuple[int, int, int]) -> tuple[float, float]:
    """ITU-R BT.601, full range."""
    r, g, b = rgb
    y = 0.299 * r + 0.587 * g + 0.114 * b
    return 128 + (b - y) * 0.564, 128 + (r - y) * 0.713


def portrait(face: tuple[int, int, int], hair_rows: int = 5, seed: int = 0) -> DepthFrame:
    """A person's head before a wall: a face with hair over it, and noise."""
    camera = Camera(kinect_v1())
    body = skeleton(Person())
    head = body.joint("head")
    assert head is not None
    u, v = (round(x) for x in pixels(head, camera))
    color = np.full((480, 640, 3), WALL, np.uint8)
    depth = np.full((480, 640), 3500, np.uint16)
    r = round(0.09 * 571.26 / head[2])
    depth[v - r : v + r, u - r : u + r] = round(head[2] * 1000) - 80
    color[v - r : v + r, u - r : u + r] = face
    color[v - r : v - r + hair_rows + r // 2, u - r : u + r] = HAIR
    noise = np.random.default_rng(seed).normal(0, 3, color.shape)
    return DepthFrame(0, depth, camera, np.clip(color + noise, 0, 255).astype(np.uint8))


@pytest.mark.parametrize("face", [LIGHT, DARK])
def test_the_face_teaches_the_skin_in_spite_of_hair_and_wall(face: tuple[int, int, int]) -> None:
    skin = face_skin(portrait(face), skeleton(Person()), CONFIG)
    assert skin is not None
    assert skin.mean == pytest.approx(cb_cr(face), abs=2.5)
    own, wall = likelihood(skin, np.array([cb_cr(face), cb_cr(WALL)], np.float32))
    assert own > 0.8 and wall < 1e-3


def test_no_face_no_skin() -> None:
    body = skeleton(Person())
    assert face_skin(portrait(LIGHT).without_color(), body, CONFIG) is None
    assert face_skin(portrait((20, 160, 60)), body, CONFIG) is None, "a green mask"
    body.joints_m[0] = np.nan
    assert face_skin(portrait(LIGHT), body, CONFIG) is None
    assert fit_skin(np.zeros((0, 2), np.float32), CONFIG) is None


def test_memory_averages_and_mistrusts_what_is_far_off() -> None:
    body = skeleton(Person())
    skin = None
    for seed in range(40):
        skin = step_skin(skin, portrait(LIGHT, seed=seed), body, CONFIG)
    assert skin is not None and skin.weight == 40
    after = remembered(skin, SkinModel((skin.mean[0] + 40, skin.mean[1] - 30), skin.covariance, 1.0), CONFIG)
    assert after is not None and after.mean == pytest.approx(skin.mean, abs=0.5)
    assert step_skin(skin, portrait(LIGHT).without_color(), body, CONFIG) == skin
    assert step_skin(None, portrait(LIGHT), body, HandConfig(hand="paper")) is None


def test_a_profile_is_where_memory_begins() -> None:
    config = HandConfig(skin=(108.0, 152.0, 20.0, -5.0, 15.0))
    stored = stored_skin(config)
    assert stored is not None and stored.mean == (108.0, 152.0)
    assert step_skin(None, portrait(LIGHT).without_color(), skeleton(Person()), config) == stored
    assert stored_skin(CONFIG) is None


def test_likelihood_is_one_at_the_mean_and_falls_with_distance() -> None:
    skin = generic_skin(CONFIG)
    line = np.stack([np.linspace(skin.mean[0], 200, 20), np.full(20, skin.mean[1])], axis=1).astype(np.float32)
    values = likelihood(skin, line)
    assert values[0] == pytest.approx(1.0) and (np.diff(values) < 0).all()
    assert chroma(np.array([[LIGHT]], np.uint8))[0, 0] == pytest.approx(cb_cr(LIGHT), abs=1.0)
