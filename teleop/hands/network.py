"""The small convolutional network that tells an open hand from a fist, in plain numpy: three million products a hand.

Three convolutions with stride 2 and two full layers, rectified linear units between; weights in ``models/hands.npz``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final, Literal
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt

from teleop.errors import DataError
from teleop.hands.patch import COLOR_LAYERS, DEPTH_LAYERS, SIZE

Array = npt.NDArray[np.float32]
Sight = Literal["both", "depth", "color", "base"]
"""What a network looks at: depth and colour, depth alone, colour alone; base: colour, before it saw any webcam."""
LAYERS_OF: Final[dict[Sight, tuple[int, ...]]] = {
    "both": (*DEPTH_LAYERS, *COLOR_LAYERS),
    "depth": DEPTH_LAYERS,
    "color": COLOR_LAYERS,
    "base": COLOR_LAYERS,
}
KERNELS: Final = (5, 3, 3)
WIDTHS: Final = (24, 48, 64)
HIDDEN: Final = 64
STRIDE: Final = 2
MODEL: Final = Path(__file__).resolve().parents[1] / "models" / "hands.npz"


@dataclass(frozen=True, slots=True, eq=False)
class Network:
    """weight: per layer, (inputs, outputs); bias: per layer, (outputs,). scale, offset: calibration of the logit."""

    weight: tuple[Array, ...]
    bias: tuple[Array, ...]
    scale: float = 1.0
    offset: float = 0.0

    def logit(self, patches: Array) -> npt.NDArray[np.float64]:
        """Calibrated log odds (N,) of an open hand, of patches (N, SIZE, SIZE, layers)."""
        x = patches
        for i, kernel in enumerate(KERNELS):
            x = np.maximum(columns(x, kernel) @ self.weight[i] + self.bias[i], 0.0)
        x = x.reshape(len(x), -1)
        x = np.maximum(x @ self.weight[3] + self.bias[3], 0.0)
        raw = (x @ self.weight[4] + self.bias[4])[:, 0].astype(np.float64)
        return self.scale * raw + self.offset


def columns(x: Array, kernel: int) -> Array:
    """Neighbourhoods of every second pixel: (N, H, W, C) to (N, H/2, W/2, kernel * kernel * C), zeros outside."""
    n, h, w, c = x.shape
    pad = kernel // 2
    padded = np.zeros((n, h + 2 * pad, w + 2 * pad, c), x.dtype)
    padded[:, pad : pad + h, pad : pad + w] = x
    rows, cols = (h + 1) // STRIDE, (w + 1) // STRIDE
    s = padded.strides
    view = np.lib.stride_tricks.as_strided(
        padded,
        (n, rows, cols, kernel, kernel, c),
        (s[0], STRIDE * s[1], STRIDE * s[2], s[1], s[2], s[3]),
        writeable=False,
    )
    return view.reshape(n, rows, cols, kernel * kernel * c)


def shapes(layers: int, widths: tuple[int, ...] = WIDTHS, hidden: int = HIDDEN) -> list[tuple[int, int]]:
    """Inputs and outputs of each layer of a network over so many patch layers; a stored one may be narrower."""
    out, channels, side = [], layers, SIZE
    for kernel, width in zip(KERNELS, widths, strict=True):
        out.append((kernel * kernel * channels, width))
        channels, side = width, (side + 1) // STRIDE
    return [*out, (side * side * channels, hidden), (hidden, 1)]


def save_networks(path: Path, networks: Mapping[str, Network]) -> None:
    """Write all networks into one file, weights in half precision."""
    arrays: dict[str, npt.NDArray] = {}
    for name, net in networks.items():
        for i, (w, b) in enumerate(zip(net.weight, net.bias, strict=True)):
            arrays[f"{name}_w{i}"], arrays[f"{name}_b{i}"] = w.astype(np.float16), b.astype(np.float32)
        arrays[f"{name}_calibration"] = np.array([net.scale, net.offset])
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savez_compressed(path, **arrays)  # type: ignore[arg-type]


def read_networks(path: Path, layers: Mapping[str, int], made_by: str) -> dict[str, Network]:
    """The networks of a model file, by name; layers: of the patches each of them sees. made_by: the command.

    Raises DataError when the file is missing, damaged or of other shapes.
    """
    networks: dict[str, Network] = {}
    try:
        with np.load(path) as stored:
            for name, count in layers.items():
                weight = tuple(stored[f"{name}_w{i}"].astype(np.float32) for i in range(len(KERNELS) + 2))
                bias = tuple(stored[f"{name}_b{i}"].astype(np.float32) for i in range(len(KERNELS) + 2))
                expected = shapes(count, tuple(w.shape[1] for w in weight[: len(KERNELS)]), weight[-2].shape[1])
                if [w.shape for w in weight] != expected or [b.shape for b in bias] != [(n,) for _, n in expected]:
                    raise ValueError(f"the network '{name}' has other layers than this version's")
                scale, offset = stored[f"{name}_calibration"]
                networks[name] = Network(weight, bias, float(scale), float(offset))
    except (OSError, ValueError, KeyError, IndexError, EOFError, BadZipFile) as error:
        raise DataError(f"model {path} cannot be read ({error}); make it with '{made_by}'") from error
    return networks


@lru_cache(maxsize=4)
def load_networks(path: Path = MODEL) -> dict[str, Network]:
    """The hand networks. Raises DataError when their file is missing, damaged or of other shapes."""
    return read_networks(path, {sight: len(layers) for sight, layers in LAYERS_OF.items()}, "teleop train-hands")
