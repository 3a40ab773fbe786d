"""The source's hand rule: colour space, crop, ratio."""

import numpy as np
import pytest
from stick_figure import Person, skeleton

from teleop.config.intent import HandConfig
from teleop.frames import Camera, DepthFrame, Intrinsics, kinect_v1, pixels
from teleop.hands.crop import color_pixel
from teleop.hands.paper import read_hand, skin_ratio
from teleop.hands.skin import cleaned, skin_mask
from teleop.intent_types import Hand

CONFIG = HandConfig(hand="paper")
SKIN = (224, 172, 138)
WALL = (60, 90, 160)


def cb_cr(rgb: tuple[int, int, int]) -> tuple[float, float]:
    """ITU-R BT.601, full range."""
    r, g, b = rgb
    y = 0.299 * r + 0.587 * g + 0.114 * b
    return 128 + (b - y) * 0.564, 128 + (r - y) * 0.713


@pytest.mark.parametrize("rgb", [SKIN, WALL, (90, 60, 45), (0, 0, 0), (255, 0, 0), (255, 255, 255), (30, 160, 40)])
def test_skin_range_is_that_of_the_formula(rgb: tuple[int, int, int]) -> None:
    cb, cr = cb_cr(rgb)
    expected = 77 <= cb <= 127 and 133 <= cr <= 173
    assert skin_mask(np.full((4, 4, 3), rgb, np.uint8), CONFIG).all() == expected


def test_clean_up_removes_specks_and_pinholes() -> None:
    mask = np.zeros((20, 20), bool)
    mask[5:15, 5:15] = True
    mask[10, 10] = False
    mask[1, 1] = True
    out = cleaned(mask)
    assert out[10, 10] and not out[1, 1]


def frame(share: float, size: tuple[int, int] = (640, 480), mirrored: bool = False) -> tuple[DepthFrame, float]:
    """A picture whose right hand is a skin-coloured square of ``share`` of the crop's area."""
    width, height = size
    camera = Camera(kinect_v1(width, height), mirrored)
    body = skeleton(Person())
    u, v = pixels(body.joint("hand_right"), camera)
    color = np.full((height, width, 3), WALL, np.uint8)
    side = round(50 * width / 640)
    half = max(1, round(side * share**0.5 / 2))
    color[round(v) - half : round(v) + half, round(u) - half : round(u) + half] = SKIN
    return DepthFrame(0, np.full((height, width), 2300, np.uint16), camera, color), (2 * half / side) ** 2


@pytest.mark.parametrize("size", [(640, 480), (320, 240)])
@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("share", [0.1, 0.25, 0.45, 0.7])
def test_ratio_is_the_skin_area_over_the_crop_at_any_resolution(
    share: float, size: tuple[int, int], mirrored: bool
) -> None:
    picture, true = frame(share, size, mirrored)
    ratio = skin_ratio(picture, skeleton(Person()), "right", CONFIG)
    assert ratio == pytest.approx(true, abs=0.03)


def test_threshold_decides() -> None:
    body = skeleton(Person())
    assert read_hand(frame(0.45)[0], body, "right", CONFIG)[0] is Hand.OPEN
    assert read_hand(frame(0.25)[0], body, "right", CONFIG)[0] is Hand.FIST
    assert read_hand(frame(0.45)[0], body, "right", HandConfig(ratio=0.8))[0] is Hand.FIST, "the source's 0.8"
    assert read_hand(frame(0.45)[0].without_color(), body, "right", CONFIG) == (Hand.UNKNOWN, 0.0)
    assert read_hand(frame(0.45)[0], skeleton(Person(x=5.0)), "right", CONFIG)[0] is Hand.UNKNOWN


def test_colour_camera_beside_the_depth_camera() -> None:
    own = Intrinsics(525.0, 525.0, 319.5, 239.5, 640, 480)
    shift = ((1.0, 0.0, 0.0, 0.025), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    camera = Camera(kinect_v1(), color=own, T_color_depth=shift)
    # optical x is minus skeleton x: (-0.2 + 0.025) * 525 / 2 right of the centre
    at = color_pixel(np.array([0.2, 0.1, 2.0]), camera, 640, 480)
    assert at is not None
    assert (at.u, at.v) == pytest.approx((319.5 - 0.175 * 525 / 2, 239.5 - 0.1 * 525 / 2))
    assert color_pixel(np.array([0.2, 0.1, -1.0]), camera, 640, 480) is None
