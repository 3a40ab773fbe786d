"""Rectified patches: turned, scaled and mirrored so that hands look alike; what geometry forbids to read."""

import numpy as np
import pytest
from stick_figure import Arm, Person, skeleton

from teleop.config.intent import HandConfig
from teleop.frames import Camera, DepthFrame, kinect_v1, pixels
from teleop.hands.aim import HandAim, aim_at_hand
from teleop.hands.legible import illegible
from teleop.hands.patch import AHEAD_M, RELIEF_M, SIDE_M, SIZE, hand_depth_m, hand_patch, rectifier
from teleop.hands.skin_model import generic_skin

CONFIG = HandConfig()
SKIN = generic_skin(CONFIG)


def aim(u: float = 320.0, v: float = 240.0, z_m: float = 2.0, direction: tuple[float, float] = (0.0, -1.0)) -> HandAim:
    return HandAim(u, v, z_m, 571.26 / z_m, np.array(direction), 0.0, False)


def picture(marks: dict[tuple[int, int], int], z_mm: int = 2000, size: int = 9) -> DepthFrame:
    """A wall at 3.5 m with square marks of other depths round the given pixels."""
    depth = np.full((480, 640), 3500, np.uint16)
    for (u, v), mm in marks.items():
        depth[v - size // 2 : v + size // 2 + 1, u - size // 2 : u + size // 2 + 1] = mm
    return DepthFrame(0, depth, Camera(kinect_v1()))


@pytest.mark.parametrize("angle_deg", [0, 30, 90, 180, 250])
@pytest.mark.parametrize("z_m", [1.5, 2.0, 3.0])
def test_what_lies_ahead_of_the_hand_is_at_the_top_at_any_angle_and_distance(angle_deg: float, z_m: float) -> None:
    d = np.array([np.sin(np.radians(angle_deg)), -np.cos(np.radians(angle_deg))])
    at = aim(z_m=z_m, direction=(d[0], d[1]))
    tip = np.array([at.u, at.v]) + 0.12 * at.px_per_m * d
    frame = picture({(320, 240): int(z_m * 1000), (round(tip[0]), round(tip[1])): int(z_m * 1000)})
    near = hand_patch(frame, at, z_m, SKIN)[..., 0] < 0.5
    rows, columns = np.nonzero(near[: SIZE // 2 - 2])
    expected = SIZE / 2 - (0.12 - AHEAD_M) * SIZE / SIDE_M
    assert rows.mean() == pytest.approx(expected, abs=1.5)
    assert columns.mean() == pytest.approx((SIZE - 1) / 2, abs=1.5)


def test_left_hands_and_mirrored_images_become_right_hands() -> None:
    body = skeleton(Person())
    plain, mirror = Camera(kinect_v1()), Camera(kinect_v1(), mirrored=True)
    for side, camera, flipped in (("right", plain, False), ("left", plain, True), ("left", mirror, False)):
        found = aim_at_hand(body, side, camera)  # type: ignore[arg-type]
        assert found is not None and found.flipped == flipped
        A = rectifier(found)[:, :2]
        assert (np.linalg.det(A) < 0) == flipped


def test_relief_is_counted_from_the_hand_and_missing_depth_is_told() -> None:
    frame = picture({(320, 240): 2030, (320, 215): 0})
    at = aim()
    z_m = hand_depth_m(frame, at, CONFIG)
    assert z_m == pytest.approx(2.03)
    patch = hand_patch(frame, at, 2.0, SKIN)
    assert patch[..., 0].min() == pytest.approx(0.03 / RELIEF_M, abs=0.01)
    assert patch[..., 0].max() == 1.0
    assert 0 < patch[..., 1].sum() < 200
    assert not patch[..., 2:].any(), "no colour"
    assert hand_depth_m(frame, aim(z_m=2.5), CONFIG) is None


def test_brightness_is_counted_from_the_hands_own() -> None:
    depth = np.full((480, 640), 2000, np.uint16)
    patches = []
    for level in (60, 120):
        color = np.full((480, 640, 3), level // 2, np.uint8)
        color[225:255, 305:335] = level
        patches.append(hand_patch(DepthFrame(0, depth, Camera(kinect_v1()), color), aim(), 2.0, SKIN)[..., 2])
    assert np.abs(patches[0][SIZE // 2, SIZE // 2]) < 0.1
    assert patches[0][0, 0] < -0.6 and patches[1][0, 0] < -0.6
    assert patches[0][0, 0] == pytest.approx(patches[1][0, 0], abs=0.25)


def test_a_hand_at_the_edge_of_the_image_gives_a_patch_all_the_same() -> None:
    patch = hand_patch(picture({(630, 240): 2000}), aim(u=632.0), 2.0, SKIN)
    assert patch.shape == (SIZE, SIZE, 4) and np.isfinite(patch).all()
    assert patch[:, -1, 1].all(), "off the image there is no depth"


def test_geometry_forbids_hands_along_the_ray_and_hands_that_are_not_there() -> None:
    towards = Person(right=Arm((1.0, 0.0, 0.05), (1.0, 0.0, 0.05)))
    aside = Person(right=Arm((0.0, 0.7, -0.7), (0.0, 0.7, 0.7)))
    camera = Camera(kinect_v1())
    for person, there, why in ((towards, True, "along_ray"), (aside, True, None), (aside, False, "too_few_pixels")):
        body = skeleton(person)
        hand = body.joint("hand_right")
        at = aim_at_hand(body, "right", camera)
        assert hand is not None and at is not None
        u, v = pixels(hand, camera)
        frame = picture({(round(u), round(v)): round(hand[2] * 1000)} if there else {}, size=31)
        assert illegible(frame, at, CONFIG) == why


def test_a_joint_off_the_image_is_no_hand() -> None:
    frame = picture({(630, 240): 2000}, size=41)
    for u, v in ((-5.0, 240.0), (-300.0, 240.0), (640.0, 240.0), (320.0, 500.0)):
        assert illegible(frame, aim(u=u, v=v), CONFIG) == "off_image"


def test_unknown_arms_are_not_aimed_at() -> None:
    body = skeleton(Person())
    body.joints_m[3] = np.nan  # elbow_right
    assert aim_at_hand(body, "right", Camera(kinect_v1())) is None
