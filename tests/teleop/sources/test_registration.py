"""Colour laid over depth, checked against scenes whose geometry is known."""

from __future__ import annotations

import numpy as np
import pytest

from teleop.frames import Camera, Intrinsics
from teleop.sources.registration import Registration

DEPTH = Intrinsics(570.0, 571.0, 320.0, 240.0, 640, 480)
COLOR = Intrinsics(525.0, 524.0, 310.0, 250.0, 640, 480)
TURN_RAD = 0.02
T = (
    (np.cos(TURN_RAD), 0.0, np.sin(TURN_RAD), -0.025),
    (0.0, 1.0, 0.0, 0.004),
    (-np.sin(TURN_RAD), 0.0, np.cos(TURN_RAD), 0.001),
    (0.0, 0.0, 0.0, 1.0),
)
CAMERA = Camera(DEPTH, color=COLOR, T_color_depth=T)


def checker(points: np.ndarray) -> np.ndarray:
    """Colour of a point in space: red tells x, green y, blue z, in steps of a centimetre and coarser."""
    return np.stack(
        [128 + 60 * np.sin(4 * points[..., 0]), 128 + 60 * np.cos(4 * points[..., 1]), 40 * points[..., 2]], axis=-1
    )


def rays(k: Intrinsics) -> np.ndarray:
    u, v = np.meshgrid(np.arange(k.width), np.arange(k.height))
    return np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones(u.shape)], axis=-1)


def plane_scene(normal: np.ndarray, distance_m: float) -> tuple[np.ndarray, np.ndarray]:
    """A coloured plane seen by both cameras, each by intersecting its own rays: depth (mm) and colour image."""
    depth_m = distance_m / (rays(DEPTH) @ normal)
    matrix = np.array(T)
    back, centre = matrix[:3, :3].T, -matrix[:3, :3].T @ matrix[:3, 3]
    directions = rays(COLOR) @ back.T  # the colour camera's rays in the depth camera's axes
    reach = (distance_m - centre @ normal) / (directions @ normal)
    color = checker(centre + directions * reach[..., None])
    return (depth_m * 1e3).round().astype(np.uint16), color.round().astype(np.uint8)


@pytest.mark.parametrize("tilt", [(0.0, 0.0, 1.0), (0.3, 0.1, 1.0), (-0.2, -0.3, 1.0)])
@pytest.mark.parametrize("distance_m", [1.0, 2.3])
def test_every_pixel_has_the_colour_of_its_point(tilt: tuple[float, ...], distance_m: float) -> None:
    normal = np.array(tilt) / np.linalg.norm(tilt)
    depth_mm, color = plane_scene(normal, distance_m)
    registration = Registration(CAMERA)
    found = registration(depth_mm, color)
    expected = checker(rays(DEPTH) * (depth_mm[..., None] * 1e-3))
    taken = found.any(axis=-1)
    assert taken.mean() > 0.9  # the rest lies outside the colour camera's view
    assert np.abs(found[taken].astype(float) - expected[taken]).max() < 4.0  # half a pixel of the pattern
    assert registration.camera == Camera(DEPTH)


def test_what_a_nearer_thing_hides_is_black_and_not_of_its_colour() -> None:
    depth = np.full((480, 640), 3000, np.uint16)
    depth[:, 300:340] = 1000
    color = np.zeros((480, 640, 3), np.uint8)
    color[..., 1] = 200  # the wall
    # the near strip, as the colour camera beside it sees it
    step = (0.0, 0.0, 0.0)
    shift = ((1.0, 0.0, 0.0, -0.05), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (*step, 1.0))
    left, right = (round((u - DEPTH.cx) - 0.05 / 1.0 * DEPTH.fx + DEPTH.cx) for u in (300, 339))
    color[:, left : right + 1] = (200, 0, 0)
    found = Registration(Camera(DEPTH, color=DEPTH, T_color_depth=shift))(depth, color)
    np.testing.assert_array_equal(np.unique(found[:, 302:338].reshape(-1, 3), axis=0), [[200, 0, 0]])
    wall = np.ones(640, bool)
    wall[299:341] = False
    assert not (found[:, wall, 0] > 0).any(), "no wall pixel takes the strip's colour"
    hidden = (found[240] == 0).all(axis=-1)
    # parallax: 0.05 m * fx * (1/1 m - 1/3 m) = 19 pixels of the wall lie behind the strip, on one side of it
    assert 17 <= hidden[wall & (np.arange(640) > 20)].sum() <= 21


def test_no_reading_and_small_colour_images() -> None:
    depth_mm, color = plane_scene(np.array([0.0, 0.0, 1.0]), 2.0)
    depth_mm[100:200] = 0
    found = Registration(CAMERA)(depth_mm, color[::2, ::2])
    assert not found[100:200].any()
    expected = checker(rays(DEPTH) * (depth_mm[..., None] * 1e-3))
    taken = found.any(axis=-1)
    assert np.abs(found[taken].astype(float) - expected[taken]).max() < 6.0


def test_registered_colour_needs_none() -> None:
    with pytest.raises(ValueError, match="already"):
        Registration(Camera(DEPTH))
