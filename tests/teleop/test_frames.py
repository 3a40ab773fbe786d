"""The frame's contract: axes, projection round trip, refusals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleop.errors import FrameError
from teleop.frames import Camera, DepthFrame, Intrinsics, kinect_v1, pixels, points_m


@pytest.mark.parametrize("mirrored", [False, True])
@given(u=st.floats(0, 639), v=st.floats(0, 479), z=st.floats(0.3, 8.0))
def test_projection_round_trip(mirrored: bool, u: float, v: float, z: float) -> None:
    camera = Camera(mirrored=mirrored)
    p = points_m([u], [v], [z], camera)
    np.testing.assert_allclose(pixels(p, camera)[0], [u, v], atol=1e-6)


def test_axes_operators_right_is_left_in_an_unmirrored_image() -> None:
    left_of_image = points_m([100.0], [240.0], [2.0], Camera())[0]
    assert left_of_image[0] > 0, "the operator's right (+x) is on the left of an unmirrored image"
    assert points_m([100.0], [240.0], [2.0], Camera(mirrored=True))[0][0] < 0
    assert points_m([320.0], [100.0], [2.0], Camera())[0][1] > 0, "up is +y"


def test_skeleton_space_is_right_handed() -> None:
    """x cross y must be z for the physical directions, not for a reflected copy of them."""
    # Physical directions in the optical frame (x right, y down, z forward), which is right-handed.
    x = np.array([-1.0, 0.0, 0.0])
    y = np.array([0.0, -1.0, 0.0])
    np.testing.assert_allclose(np.cross(x, y), [0.0, 0.0, 1.0])


@pytest.mark.parametrize(
    ("depth", "words"),
    [
        (np.zeros((480, 640), np.uint8), "16-bit"),
        (np.zeros((480, 640, 3), np.uint16), "2-D"),
        (np.zeros((240, 320), np.uint16), "camera.json"),
    ],
)
def test_bad_depth_is_refused_with_the_next_step(depth: np.ndarray, words: str) -> None:
    with pytest.raises(FrameError, match=words):
        DepthFrame(t_ns=0, depth_mm=depth, camera=Camera())


def test_bad_color_is_refused() -> None:
    with pytest.raises(FrameError, match="RGB"):
        DepthFrame(0, np.zeros((480, 640), np.uint16), Camera(), color_rgb=np.zeros((480, 640), np.uint8))


@pytest.mark.parametrize("values", [(0.0, 500.0, 1.0, 1.0, 10, 10), (500.0, 500.0, float("nan"), 1.0, 10, 10)])
def test_bad_intrinsics_are_refused(values: tuple) -> None:
    with pytest.raises(FrameError, match="fx"):
        Intrinsics(*values)


def test_scaled_camera_sees_the_same_rays() -> None:
    full, half = kinect_v1(), kinect_v1(320, 240)
    # the corner between the first four pixels of the full image is the centre of the first pixel of the half one
    ray_full = (0.5 - full.cx) / full.fx
    ray_half = (0.0 - half.cx) / half.fx
    assert ray_half == pytest.approx(ray_full)
