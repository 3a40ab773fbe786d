"""The networks as arrays of a model file, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from teleop.body.cascade import N_CUES, Cascade
from teleop.body.coarse import N_OUTPUTS, CoarseNet
from teleop.body.crop import LOCAL, WHOLE
from teleop.body.finder import BLOCK, Finder
from teleop.body.layers import F32, Convolution, Stack
from teleop.body.limbs import GROUP_NAMES, LINKS, LimbNet
from teleop.joints import N_JOINTS

Arrays = Mapping[str, npt.NDArray[Any]]
_DENSE = ("first", "first_bias", "second", "second_bias", "last", "last_bias")


def _pack(name: str, stack: Stack) -> dict[str, npt.NDArray[Any]]:
    out: dict[str, npt.NDArray[Any]] = {
        f"{name}_shape": np.array([(c.size, c.stride, int(c.residual)) for c in stack.layers], np.int32)
    }
    for n, layer in enumerate(stack.layers):
        out[f"{name}_kernel_{n}"], out[f"{name}_bias_{n}"] = _half(layer.kernel), layer.bias
    return out


def _half(values: F32) -> npt.NDArray[np.float16]:
    """Weights are kept in half precision: half the size, and 0.01 mm at a joint."""
    return values.astype(np.float16)


def _array(data: Arrays, name: str, *shape: int) -> F32:
    values = np.ascontiguousarray(data[name], np.float32)
    if values.shape != shape or not np.isfinite(values).all():
        raise ValueError(f"array '{name}' has shape {values.shape} instead of {shape}, or holds infinite numbers")
    return values


def _layers(name: str, data: Arrays, inputs: int) -> tuple[Stack, int]:
    """The convolutions and the channels that come out. Raises ValueError when they do not fit together."""
    out = []
    for n, (size, stride, residual) in enumerate(data[f"{name}_shape"].tolist()):
        outputs = len(data[f"{name}_bias_{n}"])
        if size < 1 or stride < 1 or (residual and not (outputs == inputs and stride == 1)):
            raise ValueError(f"layer {n} of the {name} network does not fit the one before")
        kernel = _array(data, f"{name}_kernel_{n}", size * size * inputs, outputs)
        out.append(Convolution(kernel, _array(data, f"{name}_bias_{n}", outputs), size, stride, bool(residual)))
        inputs = outputs
    return Stack(tuple(out)), inputs


def _features(stack: Stack, channels: int) -> int:
    """Values that the convolutions make of one local crop."""
    rows, columns = LOCAL.rows, LOCAL.columns
    for layer in stack.layers:
        rows, columns = -(-rows // layer.stride), -(-columns // layer.stride)
    return rows * columns * channels


def finder_arrays(finder: Finder) -> dict[str, npt.NDArray[Any]]:
    """All arrays, by name."""
    return {
        **_pack("finder_coming", finder.coming),
        **_pack("finder_deep", finder.deep),
        **_pack("finder_last", finder.last),
        "finder_up": _half(finder.up),
        "finder_side": _half(finder.side),
        "finder_bias": finder.bias,
        "finder_head": _half(finder.head),
        "finder_head_bias": finder.head_bias,
    }


def finder_of(data: Arrays) -> Finder:
    """The finder of such arrays. Raises KeyError when one is missing, ValueError when they do not fit together."""
    coming, middle = _layers("finder_coming", data, 2)
    deep, low = _layers("finder_deep", data, middle)
    joined = len(data["finder_bias"])
    last, _ = _layers("finder_last", data, joined)
    if len(last.layers) != 1 or not last.layers[0].residual:
        raise ValueError("the finder's last layer does not fit the one before")
    cells = BLOCK * BLOCK
    return Finder(
        coming=coming,
        deep=deep,
        up=_array(data, "finder_up", low, joined),
        side=_array(data, "finder_side", middle, joined),
        bias=_array(data, "finder_bias", joined),
        last=last,
        head=_array(data, "finder_head", joined, cells),
        head_bias=_array(data, "finder_head_bias", cells),
    )


def coarse_arrays(coarse: CoarseNet) -> dict[str, npt.NDArray[Any]]:
    """All arrays, by name."""
    return {
        **_pack("coarse", coarse.stack),
        "coarse_head": _half(coarse.head),
        "coarse_head_bias": coarse.head_bias,
    }


def coarse_of(data: Arrays) -> CoarseNet:
    """The coarse network of such arrays. Raises KeyError, ValueError as finder_of."""
    convolutions, channels = _layers("coarse", data, 2)
    outputs = N_JOINTS * N_OUTPUTS
    head = _array(data, "coarse_head", channels, outputs)
    return CoarseNet(convolutions, head, _array(data, "coarse_head_bias", outputs))


def limb_arrays(name: str, net: LimbNet) -> dict[str, npt.NDArray[Any]]:
    """All arrays, their names beginning with ``name``."""
    out = _pack(name, net.stack)
    for part in _DENSE:
        values = getattr(net, part)
        out[f"{name}_{part}"] = values if part.endswith("bias") else _half(values)
    return out


def limb_of(name: str, data: Arrays) -> LimbNet:
    """The limb network of such arrays. Raises KeyError, ValueError as finder_of."""
    convolutions, channels = _layers(name, data, 2)
    h1, h2 = len(data[f"{name}_first_bias"]), len(data[f"{name}_second_bias"])
    return LimbNet(
        convolutions,
        _array(data, f"{name}_first", LINKS * _features(convolutions, channels) + 3 * N_JOINTS, h1),
        _array(data, f"{name}_first_bias", h1),
        _array(data, f"{name}_second", h1, h2),
        _array(data, f"{name}_second_bias", h2),
        _array(data, f"{name}_last", h2, 4 * LINKS),
        _array(data, f"{name}_last_bias", 4 * LINKS),
    )


def cascade_arrays(cascade: Cascade) -> dict[str, npt.NDArray[Any]]:
    """All arrays, by name."""
    out = coarse_arrays(cascade.coarse) | {"rounds": np.array(len(cascade.rounds)), "trust": cascade.trust}
    for number, nets in enumerate(cascade.rounds):
        for group, net in zip(GROUP_NAMES, nets, strict=False):
            out |= limb_arrays(f"{group}_{number}", net)
    return out


def cascade_of(data: Arrays) -> Cascade:
    """The cascade of such arrays. Raises KeyError, ValueError as finder_of."""
    rounds = []
    for number in range(int(data["rounds"])):
        groups = tuple(group for group in GROUP_NAMES if f"{group}_{number}_first" in data)
        if groups != GROUP_NAMES and (number == 0 or groups != GROUP_NAMES[:1]):
            raise ValueError(
                f"look {number} is at {groups}: the first must be at all groups, a later one at all or arms"
            )
        rounds.append(tuple(limb_of(f"{group}_{number}", data) for group in groups))
    return Cascade(coarse_of(data), tuple(rounds), _array(data, "trust", N_CUES + 1).astype(np.float64))


def crop_note() -> str:
    """What the networks see, for the model card."""
    return (
        f"{WHOLE.rows} x {WHOLE.columns} cells of {1000 * WHOLE.cell_m:g} mm round the operator, "
        f"{LOCAL.rows} x {LOCAL.columns} cells of {1000 * LOCAL.cell_m:g} mm round each joint"
    )
