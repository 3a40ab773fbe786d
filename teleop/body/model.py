"""The trained body model: trees, leaves with part distributions and joint votes, and what was fitted on validation.

File format: numpy ``.npz`` (compressed), arrays as in BodyModel, ``meta`` a JSON string.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from teleop.body.cascade import Cascade
from teleop.body.finder import Finder
from teleop.body.network_file import cascade_arrays, cascade_of, finder_arrays, finder_of
from teleop.body.parts import N_PARTS
from teleop.body.person import N_FEATURES
from teleop.errors import ModelError
from teleop.joints import BONES, N_JOINTS

FORMAT: Final = "greenhouse-teleop body model 3"
OFFSET_UNIT_M: Final = 1e-4
"""Offsets of the features are stored as int16 in tenths of a millimetre."""
SPREAD_UNIT_M: Final = 0.002
"""Spread of a vote is stored as uint8 in steps of 2 mm."""
MODELS: Final = Path(__file__).resolve().parents[1] / "models"
DEFAULT_MODEL: Final = MODELS / "body.npz"


def pack_nodes(
    offsets: npt.NDArray[np.int16], thresholds_mm: npt.NDArray[np.int16], children: npt.NDArray[np.int32]
) -> npt.NDArray[np.int16]:
    """All that a step down a tree reads, (M, 8) int16: four offsets, the threshold, nothing, the left child as int32.

    A node is 16 bytes of one cache line: a pixel's way down is one miss a level instead of three.
    """
    nodes = np.zeros((len(children), 8), np.int16)
    nodes[:, :4], nodes[:, 4] = offsets, thresholds_mm
    nodes.view(np.int32)[:, 3] = children
    return nodes


@dataclass(frozen=True, slots=True, eq=False)
class BodyModel:
    """Everything the tracker learned. M nodes in all trees, L leaves, P parts, K votes a leaf, J joints.

    roots: (T,) int32 first node of each tree. offsets: (M, 4) int16, feature offsets u_x, u_y, v_x, v_y in 0.1 mm
    (x to the right of the canonical image, y down). thresholds_mm: (M,) int16. children: (M,) int32 left child, the
    right one follows it; a leaf points at itself. leaves: (M,) int32 index of the leaf, -1 at inner nodes.
    leaf_parts: (L, P) uint8, 255 = 1. vote_joint: (L, K) uint8, N_JOINTS where there is no vote.
    vote_mm: (L, K, 3) int16 joint minus pixel, skeleton axes. vote_spread: (L, K) uint8 in 2 mm.
    bandwidth_m, reference: (J,) mean-shift bandwidth; summed weight of a well-seen joint. bones_m: (B,) mean length
    of teleop.joints.BONES. person_weights: see teleop.body.person. max_depth: deepest leaf. meta: provenance.
    finder, cascade: the networks, None before they are trained. nodes: see pack_nodes.
    """

    roots: npt.NDArray[np.int32]
    offsets: npt.NDArray[np.int16]
    thresholds_mm: npt.NDArray[np.int16]
    children: npt.NDArray[np.int32]
    leaves: npt.NDArray[np.int32]
    leaf_parts: npt.NDArray[np.uint8]
    vote_joint: npt.NDArray[np.uint8]
    vote_mm: npt.NDArray[np.int16]
    vote_spread: npt.NDArray[np.uint8]
    bandwidth_m: npt.NDArray[np.float64]
    reference: npt.NDArray[np.float64]
    bones_m: npt.NDArray[np.float64]
    person_weights: npt.NDArray[np.float64]
    max_depth: int
    meta: dict[str, Any]
    finder: Finder | None = None
    cascade: Cascade | None = None
    nodes: npt.NDArray[np.int16] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", pack_nodes(self.offsets, self.thresholds_mm, self.children))

    @property
    def max_offset_m(self) -> float:
        """Largest offset of any feature, for the padding of the image."""
        return float(np.abs(self.offsets.astype(np.int32)).max(initial=0)) * OFFSET_UNIT_M


_ARRAYS: Final = {
    "roots": np.int32,
    "offsets": np.int16,
    "thresholds_mm": np.int16,
    "children": np.int32,
    "leaves": np.int32,
    "leaf_parts": np.uint8,
    "vote_joint": np.uint8,
    "vote_mm": np.int16,
    "vote_spread": np.uint8,
    "bandwidth_m": np.float64,
    "reference": np.float64,
    "bones_m": np.float64,
    "person_weights": np.float64,
}


def model_arrays(model: BodyModel) -> dict[str, npt.NDArray[Any]]:
    """All arrays, by name, and the meta data as a JSON string."""
    header = {"format": FORMAT, "max_depth": model.max_depth, **model.meta}
    arrays: dict[str, npt.NDArray[Any]] = {
        name: np.asarray(getattr(model, name), dtype) for name, dtype in _ARRAYS.items()
    }
    if model.finder is not None:
        arrays |= finder_arrays(model.finder)
    if model.cascade is not None:
        arrays |= cascade_arrays(model.cascade)
    return arrays | {"meta": np.array(json.dumps(header))}


def model_of(data: Mapping[str, npt.NDArray[Any]]) -> BodyModel:
    """The model of such arrays. Raises ModelError for another format, KeyError or ValueError for what is missing or
    does not fit together."""
    header = json.loads(str(data["meta"]))
    if header.pop("format", None) != FORMAT:
        raise ModelError(f"another format than '{FORMAT}'")
    arrays: dict[str, Any] = {name: np.ascontiguousarray(data[name]) for name in _ARRAYS}
    model = BodyModel(
        **arrays,
        max_depth=int(header.pop("max_depth")),
        meta=header,
        finder=finder_of(data) if "finder_bias" in data else None,
        cascade=cascade_of(data) if "trust" in data else None,
    )
    _check(model)
    return model


def save_model(model: BodyModel, path: Path) -> None:
    """Write the model; the folder must exist."""
    with path.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **model_arrays(model))


def load_model(path: Path | None = None) -> BodyModel:
    """Read a model; None reads the shipped one. Raises ModelError when there is none or it is wrong."""
    path = DEFAULT_MODEL if path is None else path
    if not path.is_file():
        raise ModelError(f"body model '{path}' not found; make one with 'teleop train --output {path}'")
    try:
        with np.load(path, allow_pickle=False) as data:
            return model_of(data)
    except (KeyError, ValueError, OSError, EOFError, zipfile.BadZipFile, ModelError) as error:
        raise ModelError(f"'{path}' is no body model ({error}); make one with 'teleop train'") from error


def _check(model: BodyModel) -> None:
    """Raise ValueError unless every index in the arrays is legal: the kernels check nothing."""
    nodes, leaves = len(model.children), len(model.leaf_parts)
    at_leaf = model.leaves >= 0
    sound = (
        all(getattr(model, name).dtype == dtype for name, dtype in _ARRAYS.items())
        and model.offsets.shape == (nodes, 4)
        and model.thresholds_mm.shape == model.leaves.shape == (nodes,)
        and model.leaf_parts.shape == (leaves, N_PARTS)
        and model.vote_mm.shape == (*model.vote_joint.shape, 3)
        and model.vote_spread.shape == model.vote_joint.shape
        and len(model.vote_joint) == leaves
        and model.bandwidth_m.shape == model.reference.shape == (N_JOINTS,)
        and model.bones_m.shape == (len(BONES),)
        and model.person_weights.shape == (2 * N_FEATURES + 1,)
        and nodes > 0
        and bool((model.roots >= 0).all() and (model.roots < nodes).all())
        and bool((model.children >= 0).all() and (model.children[~at_leaf] < nodes - 1).all())
        and bool((model.children[at_leaf] == np.flatnonzero(at_leaf)).all())
        and bool((model.leaves < leaves).all())
    )
    if not sound:
        raise ValueError("its arrays do not fit together")
