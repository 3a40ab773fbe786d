"""Training frames from the MakeHuman files: deterministic, consistent, splits apart."""

import numpy as np
import pytest

from teleop.body.parts import NO_PART, PART_NAMES
from teleop.data import data_root
from teleop.frames import points_m
from teleop.joints import JOINT_INDEX, JOINT_NAMES
from teleop.people import mocap
from teleop.people.body import skin
from teleop.people.sampling import SampleSpec, person, sample_frame
from teleop.people.shape import random_shape

pytestmark = [
    pytest.mark.data,
    pytest.mark.skipif(
        data_root() is None or not (data_root() / "makehuman").is_dir(), reason="the MakeHuman files are not here"
    ),
]
SMALL = {"width": 320, "height": 240}


@pytest.fixture(scope="module")
def frames():
    return [sample_frame(seed, SampleSpec(mirrored=seed % 2 == 1, **SMALL)) for seed in range(24)]


def test_the_same_seed_gives_the_same_frame():
    for spec in (SampleSpec(**SMALL), SampleSpec(room=True, color=True, **SMALL)):
        a, b = sample_frame(5, spec), sample_frame(5, spec)
        assert (a.frame.depth_mm == b.frame.depth_mm).all()
        assert (a.part == b.part).all()
        assert (a.joints_m == b.joints_m).all()
    assert (a.frame.color_rgb == b.frame.color_rgb).all()


def test_labels_lie_on_read_pixels_only(frames):
    for f in frames:
        assert not (f.frame.depth_mm[f.part != NO_PART] == 0).any()
        assert set(np.unique(f.part)) <= {*range(len(PART_NAMES)), NO_PART}


def test_seen_joints_have_skin_of_their_part_nearby(frames):
    distances = []
    for f in frames:
        for j in np.flatnonzero(f.visible):
            v, u = np.nonzero(f.part == j)
            if len(u):
                p = points_m(u, v, f.frame.depth_mm[v, u] / 1000.0, f.frame.camera)
                distances.append(np.linalg.norm(p - f.joints_m[j], axis=1).min())
    assert len(distances) > 150
    assert np.percentile(distances, 95) < 0.16


def test_left_and_right_are_the_persons_in_both_images(frames):
    """Right parts lie to the right of left ones along the person's own shoulder line, mirrored image or not."""
    for f in frames:
        right = f.joints_m[JOINT_INDEX["hip_right"]] - f.joints_m[JOINT_INDEX["hip_left"]]
        sides = []
        for side in ("right", "left"):
            v, u = np.nonzero(f.part == PART_NAMES.index(f"hip_{side}"))
            if len(u) < 20:
                break
            sides.append(points_m(u, v, f.frame.depth_mm[v, u] / 1000.0, f.frame.camera).mean(axis=0))
        if len(sides) == 2:
            assert (sides[0] - sides[1]) @ right > 0


def test_a_room_surrounds_the_person():
    f = sample_frame(3, SampleSpec(room=True, **SMALL))
    assert (f.frame.depth_mm > 0).mean() > 0.6
    assert (f.part == NO_PART).mean() > 0.3


def test_people_of_the_splits_differ():
    heights = {split: {person(split, n).height_m for n in range(8)} for split in ("train", "validation", "test")}
    assert not heights["train"] & heights["validation"] | heights["train"] & heights["test"]


def test_recorded_poses_of_the_splits_differ():
    keys = {}
    for split in ("train", "validation", "test"):
        recorded = mocap.library(split)
        if recorded is None:
            pytest.skip("no recorded motions here (cmu_mocap, kinect_skeletons)")
        keys[split] = {row.tobytes() for row in recorded.limbs[::7]}
        assert len(recorded) > 300
    assert not keys["train"] & keys["test"]
    assert not keys["train"] & keys["validation"]


def test_bodies_have_the_height_and_mass_asked_for():
    for n in range(6):
        shape = random_shape(np.random.default_rng([11, n]))
        body = person("train", n)
        assert np.ptp(body.vertices_m[:, 1]) == pytest.approx(shape.height_m, abs=1e-3)
        a, b, c = (body.vertices_m[body.faces[:, k]].astype(float) for k in range(3))
        mass = 1010 * np.einsum("ij,ij->", a, np.cross(b, c)) / 6
        assert 38 < mass < 125
        assert mass == pytest.approx(shape.mass_kg, rel=0.2)


def test_makehuman_joints_stand_as_kinects_do():
    """Base of the neck above the shoulders; skull centre 9 cm below the crown; limbs of human proportions."""
    body = person("test", 0)
    rig = body.rig
    assert body.height_m - rig.skull_m[1] == pytest.approx(0.09)
    upper = np.linalg.norm(rig.bone("forearm_right") - rig.bone("upper_arm_right")) / body.height_m
    thigh = np.linalg.norm(rig.bone("shin_right") - rig.bone("thigh_right")) / body.height_m
    assert 0.13 < upper < 0.20
    assert 0.20 < thigh < 0.29
    assert len(JOINT_NAMES) == 20


def test_skinning_keeps_the_volume_roughly():
    from teleop.people.moves import random_pose
    from teleop.people.pose import pose_rig

    body = person("train", 1)

    def volume(v):
        a, b, c = (v[body.faces[:, k]].astype(float) for k in range(3))
        return np.einsum("ij,ij->", a, np.cross(b, c)) / 6

    for seed in range(8):
        posed = skin(body, pose_rig(body.rig, random_pose(np.random.default_rng(seed))))
        assert volume(posed) == pytest.approx(volume(body.vertices_m), rel=0.08)
