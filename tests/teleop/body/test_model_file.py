"""Reading and writing model files."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from teleop.body.model import DEFAULT_MODEL, load_model, save_model
from teleop.errors import ModelError


def test_shipped_model_is_small_and_survives_a_round_trip(tmp_path: Path) -> None:
    assert DEFAULT_MODEL.stat().st_size <= 20_000_000
    model = load_model()
    save_model(model, tmp_path / "copy.npz")
    copy = load_model(tmp_path / "copy.npz")
    assert (copy.vote_mm == model.vote_mm).all()
    assert copy.meta == model.meta
    assert copy.max_depth == model.max_depth


def test_missing_model_says_how_to_make_one(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="teleop train"):
        load_model(tmp_path / "none.npz")


def test_other_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "text.npz").write_text("no model")
    with pytest.raises(ModelError, match="no body model"):
        load_model(tmp_path / "text.npz")
    np.savez(tmp_path / "other.npz", a=np.zeros(3))
    with pytest.raises(ModelError, match="no body model"):
        load_model(tmp_path / "other.npz")
    whole = DEFAULT_MODEL.read_bytes()
    (tmp_path / "cut.npz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ModelError, match="no body model"):
        load_model(tmp_path / "cut.npz")


def test_index_out_of_range_is_refused(tmp_path: Path) -> None:
    model = load_model()
    children = model.children.copy()
    children[0] = len(children) + 5
    save_model(replace(model, children=children), tmp_path / "bad.npz")
    with pytest.raises(ModelError, match="do not fit"):
        load_model(tmp_path / "bad.npz")
