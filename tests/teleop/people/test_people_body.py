"""The built-in body: closed mesh, sane weights, parts on the right side, height and girth as asked."""

import numpy as np
import pytest

from teleop.body.parts import MIRROR_PART, N_PARTS, PART_NAMES
from teleop.people.body import skin, vertex_normals
from teleop.people.builtin import builtin_body
from teleop.people.moves import random_pose
from teleop.people.pose import pose_rig
from teleop.people.rig import N_BONES, Posed
from teleop.people.shape import Shape

BODY = builtin_body()


@pytest.mark.parametrize("height_m", [1.50, 1.76, 2.00])
def test_height_is_as_asked(height_m):
    body = builtin_body(Shape(height_m=height_m))
    assert np.ptp(body.vertices_m[:, 1]) == pytest.approx(height_m, abs=0.03)
    assert body.vertices_m[:, 1].min() == pytest.approx(0.0, abs=1e-6)


def test_a_heavier_person_is_wider():
    thin, heavy = builtin_body(Shape(mass_kg=55)), builtin_body(Shape(mass_kg=105))

    def waist(body):
        band = body.vertices_m[np.abs(body.vertices_m[:, 1] - 0.62 * body.height_m) < 0.04]
        return np.ptp(band[np.abs(band[:, 0]) < 0.3, 0])

    assert waist(heavy) > 1.2 * waist(thin)


def test_every_edge_joins_two_faces():
    edges = np.sort(np.concatenate([BODY.faces[:, [0, 1]], BODY.faces[:, [1, 2]], BODY.faces[:, [2, 0]]]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    assert (count == 2).all()


def test_faces_look_outwards():
    a, b, c = (BODY.vertices_m[BODY.faces[:, k]].astype(float) for k in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0


def test_all_parts_are_there_and_on_their_side():
    assert set(np.unique(BODY.face_part)) == set(range(N_PARTS))
    x = BODY.vertices_m[BODY.faces].mean(axis=1)[:, 0]
    for i, name in enumerate(PART_NAMES):
        if name.endswith("_right"):
            assert np.median(x[BODY.face_part == i]) > 0, name
        if name.endswith("_left"):
            assert np.median(x[BODY.face_part == i]) < 0, name


def test_parts_are_alike_on_both_sides():
    count = np.bincount(BODY.face_part, minlength=N_PARTS)
    for i, other in enumerate(MIRROR_PART):
        assert count[i] == pytest.approx(count[other], rel=0.1), PART_NAMES[i]


def test_the_rest_pose_leaves_the_skin_where_it_is():
    rest = Posed(np.tile(np.eye(3), (N_BONES, 1, 1)), BODY.rig.head_m.copy())
    assert np.allclose(skin(BODY, rest), BODY.vertices_m, atol=1e-5)


def test_skin_follows_a_rigid_motion():
    posed = pose_rig(BODY.rig, random_pose(np.random.default_rng(2)))
    t = np.array([0.1, -0.5, 2.0])
    assert np.allclose(skin(BODY, posed.moved(np.eye(3), t)), skin(BODY, posed) + t.astype(np.float32), atol=1e-5)


def test_normals_have_unit_length():
    n = vertex_normals(BODY.vertices_m, BODY.faces)
    assert np.allclose(np.linalg.norm(n, axis=1), 1.0, atol=1e-4)
