"""The tomato study: the source's grid, voids counted right, breaches and misprints reported, motion written."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from robot_sim.arms.config import TomatoArmConfig
from robot_sim.arms.tomato import tomato_arm
from robot_sim.kinematics import chain_from_urdf
from robot_sim.studies.config import TomatoStudyConfig
from robot_sim.studies.tomato import TomatoOutcome, run_tomato_study, source_combinations
from robot_sim.studies.workspace import count_voids, joint_grid, occupancy


def test_the_sources_stepping() -> None:
    np.testing.assert_allclose(np.degrees(joint_grid(-180, 180, 80)), [-180, -100, -20, 60, 140])
    np.testing.assert_allclose(np.degrees(joint_grid(-170, 170, 50)), [-170, -120, -70, -20, 30, 80, 130])
    q = source_combinations(TomatoArmConfig(), TomatoStudyConfig())
    assert q.shape == (5 * 7 * 7 * 8 * 7, 5)
    assert len(np.unique(q, axis=0)) == len(q)


def test_a_hollow_ball_has_one_void_and_an_open_one_has_none() -> None:
    g = np.stack(np.meshgrid(*[np.arange(-10, 11)] * 3, indexing="ij"), axis=-1)
    r = np.linalg.norm(g, axis=-1)
    hollow = (r < 9.5) & (r > 5)
    found = count_voids(hollow, 0.1, 0)
    assert found.pockets == 1
    assert found.enclosed == int((r <= 5).sum())
    assert found.enclosed_m3 == pytest.approx(found.enclosed * 1e-3)
    hollow[10, 10, :] = False  # a shaft to the outside
    assert count_voids(hollow, 0.1, 0).enclosed == 0


def test_occupancy_marks_each_point_once() -> None:
    hit = occupancy(np.array([[0.0, 0, 0], [0.01, 0, 0], [0.95, 0.0, 0.45]]), 0.1)
    assert hit.shape == (10, 1, 5) and hit.sum() == 2


@pytest.fixture(scope="module")
def outcome(tmp_path_factory: pytest.TempPathFactory) -> TomatoOutcome:
    return run_tomato_study(tmp_path_factory.mktemp("tomato"), quick=True)


def test_the_study_reports_what_the_source_left_out(outcome: TomatoOutcome) -> None:
    folder = outcome.page.parent
    assert outcome.fine.enclosed == 0
    assert outcome.breaches == ("joint2 breaks its upper limit: 180.0 against 170.0 deg",)
    page = outcome.page.read_text(encoding="utf-8")
    assert "180.0 against 170.0" in page and "theta1 may lie anywhere" in page
    with (folder / "formulas.csv").open(encoding="utf-8") as f:
        rows = {row[0]: (float(row[1]), float(row[2])) for row in list(csv.reader(f))[1:]}
    assert rows["py [m]"][0] > 0.5 and rows["py [m]"][1] < 1e-12
    assert rows["|theta34| [rad]"][0] > 1 and rows["|theta34| [rad]"][1] < 1e-6
    for name in ("workspace.png", "curves.png", "path.png", "voids.csv", "curves.csv"):
        assert (folder / name).stat().st_size > 100


def test_the_recording_holds_the_motion(outcome: TomatoOutcome) -> None:
    arm = tomato_arm()
    with (outcome.page.parent / "motion.mcap").open("rb") as f:
        reader = make_reader(f, decoder_factories=[DecoderFactory()])
        states, transforms, scenes, urdf = [], [], [], ""
        for _, channel, message in reader.iter_messages():
            if channel.topic == "/robot_description":
                urdf = json.loads(message.data)["data"]
        for _, channel, message, decoded in reader.iter_decoded_messages(
            topics=["/joint_states", "/tf", "/study/scene"]
        ):
            kind = {"/joint_states": states, "/tf": transforms, "/study/scene": scenes}[channel.topic]
            kind.append((message.log_time, decoded))
    assert len(states) == len(transforms) == 101 and len(scenes) == 1
    t_ns, last = states[-1]
    assert t_ns == 2_000_000_000
    q = {j.name: j.position for j in last.joints}
    np.testing.assert_allclose([q[f"joint{i}"] for i in range(1, 6)], np.radians([-45, 180, 135, -90, 90]))
    chain = chain_from_urdf(urdf, tip="tool0")
    tool = arm.chain.forward(np.array([q[j.name] for j in chain.joints]))[:3, 3]
    (path,) = [e for e in scenes[0][1].entities if e.id == "path"]
    end = path.lines[0].points[-1]
    np.testing.assert_allclose([end.x, end.y, end.z], tool, atol=1e-9)
    assert [t.child_frame_id for t in transforms[0][1].transforms] == [
        "base_link",
        "link1",
        "link2",
        "link3",
        "link4",
        "link5",
        "tool0",
    ]
