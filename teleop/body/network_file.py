"""The cascade as arrays of a model file, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from teleop.body.cascade import N_CUES, Cascade
from teleop.body.chains import LINKS, ChainNet
from teleop.body.coarse import N_OUTPUTS, CoarseNet
from teleop.body.crop import LOCAL, WHOLE
from teleop.body.layers import Convolution
from teleop.body.refine import KINDS, N_NEAR, Refiner
from teleop.joints import N_JOINTS

_DENSE = ("first", "first_bias", "second", "second_bias", "last", "last_bias")


def _pack(name: str, layers: tuple[Convolution, ...]) -> dict[str, npt.NDArray[Any]]:
    out: dict[str, npt.NDArray[Any]] = {
        f"{name}_shape": np.array([(c.size, c.stride, int(c.residual)) for c in layers], np.int32)
    }
    for n, layer in enumerate(layers):
        out[f"{name}_kernel_{n}"], out[f"{name}_bias_{n}"] = layer.kernel, layer.bias
    return out


def _dense(name: str, net: Refiner | ChainNet) -> dict[str, npt.NDArray[Any]]:
    return {f"{name}_{part}": getattr(net, part) for part in _DENSE}


def _features(layers: tuple[Convolution, ...], channels: int) -> int:
    """Values that the convolutions make of one local crop."""
    rows, columns = LOCAL.rows, LOCAL.columns
    for layer in layers:
        rows, columns = -(-rows // layer.stride), -(-columns // layer.stride)
    return rows * columns * channels


def _layers(name: str, data: Mapping[str, npt.NDArray[Any]], inputs: int) -> tuple[tuple[Convolution, ...], int]:
    """The convolutions and the channels that come out. Raises ValueError when they do not fit together."""
    out = []
    for n, (size, stride, residual) in enumerate(data[f"{name}_shape"].tolist()):
        kernel = np.ascontiguousarray(data[f"{name}_kernel_{n}"], np.float32)
        bias = np.ascontiguousarray(data[f"{name}_bias_{n}"], np.float32)
        same = kernel.shape[1] == inputs and stride == 1
        if size < 1 or stride < 1 or kernel.shape != (size * size * inputs, len(bias)) or (residual and not same):
            raise ValueError(f"layer {n} of the {name} network does not fit the one before")
        out.append(Convolution(kernel, bias, size, stride, bool(residual)))
        inputs = len(bias)
    return tuple(out), inputs


def cascade_arrays(cascade: Cascade) -> dict[str, npt.NDArray[Any]]:
    """All arrays, by name."""
    coarse, refiner = cascade.coarse, cascade.refiner
    return {
        **_pack("coarse", coarse.convolutions),
        "coarse_head": coarse.head,
        "coarse_head_bias": coarse.head_bias,
        **_pack("refiner", refiner.convolutions),
        **_dense("refiner", refiner),
        **_pack("arms", cascade.limbs[0].convolutions),
        **_dense("arms", cascade.limbs[0]),
        **_pack("legs", cascade.limbs[1].convolutions),
        **_dense("legs", cascade.limbs[1]),
        "trust": cascade.trust,
    }


def cascade_of(data: Mapping[str, npt.NDArray[Any]]) -> Cascade:
    """The cascade of such arrays. Raises KeyError when one is missing, ValueError when they do not fit together."""

    def array(name: str, *shape: int) -> npt.NDArray[np.float32]:
        values = np.ascontiguousarray(data[name], np.float32)
        if values.shape != shape or not np.isfinite(values).all():
            raise ValueError(f"array '{name}' has shape {values.shape} instead of {shape}, or holds infinite numbers")
        return values

    convolutions, channels = _layers("coarse", data, 2)
    outputs = N_JOINTS * N_OUTPUTS
    coarse = CoarseNet(convolutions, array("coarse_head", channels, outputs), array("coarse_head_bias", outputs))
    convolutions, channels = _layers("refiner", data, 2)
    h1, h2, kinds = data["refiner_first_bias"].shape[-1], len(data["refiner_second_bias"]), len(KINDS)
    refiner = Refiner(
        convolutions,
        array("refiner_first", _features(convolutions, channels) + 3 * N_NEAR, h1),
        array("refiner_first_bias", kinds, h1),
        array("refiner_second", h1, h2),
        array("refiner_second_bias", h2),
        array("refiner_last", kinds, h2, 4),
        array("refiner_last_bias", kinds, 4),
    )

    def limb(name: str) -> ChainNet:
        convolutions, channels = _layers(name, data, 2)
        h1, h2 = len(data[f"{name}_first_bias"]), len(data[f"{name}_second_bias"])
        return ChainNet(
            convolutions,
            array(f"{name}_first", LINKS * _features(convolutions, channels) + 3 * N_JOINTS, h1),
            array(f"{name}_first_bias", h1),
            array(f"{name}_second", h1, h2),
            array(f"{name}_second_bias", h2),
            array(f"{name}_last", h2, 4 * LINKS),
            array(f"{name}_last_bias", 4 * LINKS),
        )

    trust = array("trust", N_CUES + 1).astype(np.float64)
    return Cascade(coarse, refiner, (limb("arms"), limb("legs")), trust)


def crop_note() -> str:
    """What the networks see, for the model card."""
    return (
        f"{WHOLE.rows} x {WHOLE.columns} cells of {1000 * WHOLE.cell_m:g} mm round the operator, "
        f"{LOCAL.rows} x {LOCAL.columns} cells of {1000 * LOCAL.cell_m:g} mm round each joint"
    )
