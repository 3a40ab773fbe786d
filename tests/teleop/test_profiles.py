"""Operator profiles: kept by name, learned from joints, laid over the settings."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from scripted import rig
from stick_figure import Person, skeleton

from teleop.config import OperatorConfig, TeleopConfig
from teleop.hands.skin_model import SkinModel
from teleop.profiles import ProfileError, ProfileStore, bone_lengths_m, learned_profile

ANN = OperatorConfig(
    name="Ann Lee",
    handedness="left",
    bones_m={"forearm": 0.25},
    skin=(110, 150, 20, -5, 15),
    thresholds={"task.T1_deg": 9},
)


def test_kept_and_found_by_name_whatever_the_case(tmp_path: Path) -> None:
    store = ProfileStore(tmp_path / "operators")
    assert store.names() == []
    store.save(ANN)
    store.save(OperatorConfig(name="bo"))
    assert store.names() == ["Ann Lee", "bo"]
    assert store.load("ann lee") == store.load("ANN LEE") == ANN
    store.remove("Ann lee")
    assert store.names() == ["bo"]


@given(st.from_regex(r"\A[A-Za-z0-9][A-Za-z0-9 ._-]{0,39}\Z"))
def test_no_name_leaves_the_folder(name: str) -> None:
    path = ProfileStore(Path("/profiles"))._path(name)
    assert path.parent == Path("/profiles") and path.suffix == ".json"


@pytest.mark.parametrize("name", ["", "../x", "a/b", "x" * 41, ".hidden", "a\nb"])
def test_other_names_are_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(ProfileError, match="no name for an operator"):
        ProfileStore(tmp_path).load(name)


def test_errors_say_what_to_do(tmp_path: Path) -> None:
    store = ProfileStore(tmp_path)
    with pytest.raises(ProfileError, match=r"no operator 'zoe'; known: none yet; .*learn"):
        store.load("zoe")
    (tmp_path / "zoe.json").write_text('{"name": "zoe", "bones_m": {"tail": 1}}')
    with pytest.raises(ProfileError, match="no bone 'tail'; legal: upper_arm"):
        store.load("zoe")
    (tmp_path / "zoe.json").write_text("{")
    with pytest.raises(ProfileError, match="not legal"):
        store.load("zoe")
    assert store.names() == ["zoe"], "a damaged profile is listed, so that it can be removed"
    blocked = tmp_path / "file"
    blocked.write_text("")
    with pytest.raises(ProfileError, match="another folder"):
        ProfileStore(blocked / "operators").save(ANN)


def test_own_values_are_laid_over_the_settings() -> None:
    config = TeleopConfig(operator=ANN)
    intent = config.effective_intent()
    assert intent.mapping.handedness == "left"
    assert intent.task.T1_deg == 9
    assert intent.hands.skin == ANN.skin
    assert config.intent.mapping.handedness == "right", "the settings themselves stay"
    assert TeleopConfig().effective_intent() == TeleopConfig().intent
    assert rig(config).pipeline.intent == intent, "and the pipeline goes by them"


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"thresholds": {"task.T1_deg": 99}}, "task.T1_deg.*less than or equal to 60"),
        ({"thresholds": {"task.nothing": 1}}, "task.nothing.*not permitted"),
        ({"thresholds": {"safety.lost_hold_s": 5}}, "legal: SECTION.NAME"),
        ({"bones_m": {"forearm": 3}}, "0.1..1.2 m"),
        ({"skin": (110, 150, 1, 9, 1)}, "positive matrix"),
        ({"name": "../x"}, "pattern"),
    ],
)
def test_values_that_do_not_fit_are_refused(values: dict[str, object], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        TeleopConfig.model_validate({"operator": {"name": "x"} | values})


def test_bones_and_skin_are_learned() -> None:
    rng = np.random.default_rng(0)
    bodies = [skeleton(Person(), i, rng) for i in range(60)]
    true = skeleton(Person())
    profile = learned_profile("Cy", bodies, SkinModel((110.0, 150.0), (20.0, -5.0, 15.0), 60.0), "left")
    elbow, wrist = true.joint("elbow_right"), true.joint("wrist_right")
    assert elbow is not None and wrist is not None
    assert profile.bones_m["forearm"] == pytest.approx(float(np.linalg.norm(elbow - wrist)), abs=0.02)
    assert profile.skin == (110, 150, 20, -5, 15)
    assert set(profile.bones_m) == {"upper_arm", "forearm", "trunk", "thigh", "shin"}


def test_too_little_of_a_person_is_no_profile() -> None:
    body = skeleton(Person())
    assert bone_lengths_m([body] * 5) == {}
    with pytest.raises(ProfileError, match="too little of a person"):
        learned_profile("Cy", [body] * 5, None, None)
