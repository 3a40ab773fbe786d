"""The z-buffer against planes and triangles whose depth is known."""

import numpy as np
import pytest

from teleop.frames import Camera, kinect_v1, pixels, points_m
from teleop.people.render import draw, empty_raster
from teleop.people.room import Room, draw_planes
from teleop.people.view import sensor_view

SQUARE = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("size", [(640, 480), (320, 240)])
def test_a_tilted_square_has_the_depth_of_its_plane(mirrored, size):
    camera = Camera(kinect_v1(*size), mirrored)
    slope = np.array([0.3, -0.2])
    points = SQUARE.copy()
    points[:, 2] = 2.5 + points[:, :2] @ slope
    raster = empty_raster(camera)
    draw(raster, camera, points, FACES)
    v, u = np.nonzero(raster.face >= 0)
    assert len(u) > 0.1 * size[0] * size[1]
    p = points_m(u, v, raster.depth_m[v, u], camera)
    assert np.allclose(p[:, 2], 2.5 + p[:, :2] @ slope, atol=2e-4)


def test_the_nearer_of_two_wins_whatever_the_order():
    camera = Camera()
    far, near = SQUARE + np.float32([0, 0, 3]), 0.3 * SQUARE + np.float32([0, 0, 2])
    for order in ((far, near), (near, far)):
        raster = empty_raster(camera)
        for k, square in enumerate(order):
            draw(raster, camera, square, FACES, 10 * k)
        assert raster.depth_m[240, 320] == pytest.approx(2.0)
        assert raster.depth_m[240, 440] == pytest.approx(3.0)


def test_a_mirrored_image_is_the_image_flipped():
    points = SQUARE * np.float32([0.3, 0.5, 1]) + np.float32([0.4, 0.1, 2.2])
    images = []
    for mirrored in (False, True):
        camera = Camera(mirrored=mirrored)
        raster = empty_raster(camera)
        draw(raster, camera, points, FACES)
        images.append(np.isfinite(raster.depth_m))
        u = np.nonzero(images[-1])[1].mean()
        assert u == pytest.approx(pixels(np.array([0.4, 0.1, 2.2]), camera)[0], abs=1.0)
    assert images[0].sum() == pytest.approx(images[1].sum(), rel=0.02)


def test_what_is_behind_the_camera_is_left_out():
    camera = Camera()
    raster = empty_raster(camera)
    draw(raster, camera, SQUARE + np.float32([0, 0, -2]), FACES)
    assert not np.isfinite(raster.depth_m).any()


def test_the_floor_lies_the_sensors_height_below_it():
    room = Room(np.array([[0.0, 1.0, 0.0]]), np.zeros(1), np.full((1, 3), 100.0), np.zeros(1))
    camera, view = Camera(), sensor_view(1.2, -0.2, 0.03)
    raster = empty_raster(camera)
    draw_planes(raster, camera, room, view)
    v, u = np.nonzero(raster.face == -2)
    assert len(u) > 50_000
    room_points = (points_m(u, v, raster.depth_m[v, u], camera) - view.t_m) @ view.R
    assert np.abs(room_points[:, 1]).max() < 1e-4
