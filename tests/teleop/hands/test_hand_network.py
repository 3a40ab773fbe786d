"""The network: forward pass against a plain convolution, gradients against finite differences, learning, the file."""

from pathlib import Path

import numpy as np
import pytest

from teleop.errors import DataError
from teleop.hands.learning.convnet import Schedule, calibrated, gradients, initial, train
from teleop.hands.learning.samples import openness
from teleop.hands.network import (
    HIDDEN,
    KERNELS,
    LAYERS_OF,
    STRIDE,
    Network,
    columns,
    load_networks,
    save_networks,
    shapes,
)
from teleop.hands.patch import SIZE


def test_columns_are_a_convolution() -> None:
    rng = np.random.default_rng(0)
    x, w = rng.standard_normal((2, 9, 9, 3)).astype(np.float32), rng.standard_normal((5, 5, 3, 4)).astype(np.float32)
    out = columns(x, 5) @ w.reshape(-1, 4)
    padded = np.pad(x, ((0, 0), (2, 2), (2, 2), (0, 0)))
    for i, j in ((0, 0), (2, 3), (4, 4)):
        window = padded[1, STRIDE * i : STRIDE * i + 5, STRIDE * j : STRIDE * j + 5]
        assert out[1, i, j] == pytest.approx(np.einsum("ijc,ijco->o", window, w), rel=1e-4, abs=1e-4)


@pytest.mark.parametrize("layer", range(len(KERNELS) + 2))
def test_gradients_by_finite_differences(layer: int) -> None:
    rng = np.random.default_rng(1)
    net = initial(2, rng)
    wide = Network(tuple(w.astype(np.float64) for w in net.weight), tuple(b.astype(np.float64) for b in net.bias))
    x, target = rng.standard_normal((3, SIZE, SIZE, 2)), np.array([0.0, 1.0, 1.0])
    keep = np.ones((3, HIDDEN))
    _, dw, db = gradients(wide, x, target, keep)

    def loss(of: str, index: tuple[int, ...], step: float) -> float:
        lists = {"weight": [w.copy() for w in wide.weight], "bias": [b.copy() for b in wide.bias]}
        lists[of][layer][index] += step
        return gradients(Network(tuple(lists["weight"]), tuple(lists["bias"])), x, target, keep)[0]

    for of, found in (("weight", dw[layer]), ("bias", db[layer])):
        index = np.unravel_index(int(np.abs(found).argmax()), found.shape)
        slope = (loss(of, index, 1e-5) - loss(of, index, -1e-5)) / 2e-5
        assert found[index] == pytest.approx(slope, rel=2e-3)


def test_it_learns_and_its_probabilities_are_honest() -> None:
    rng = np.random.default_rng(2)
    is_open = rng.random(256) < 0.5
    x = rng.normal(0, 1, (256, 1, SIZE, SIZE, 2)).astype(np.float16)
    x[is_open, :, 10:30, 10:30, 0] += 0.7
    losses: list[float] = []
    net = train(
        initial(2, rng),
        x,
        is_open.astype(np.float32),
        Schedule(epochs=8, batch=32),
        rng,
        lambda b, _: b,
        lambda _, loss: losses.append(loss),
    )
    assert losses[-1] < 0.6 * losses[0]
    logit = net.logit(x[:, 0].astype(np.float32))
    assert ((logit > 0) == is_open).mean() > 0.95
    flipped = is_open ^ (rng.random(256) < 0.2)
    cal = calibrated(net, logit, flipped)
    told = 1 / (1 + np.exp(-np.abs(cal.scale * logit + cal.offset)))
    assert told.mean() == pytest.approx(((logit > 0) == flipped).mean(), abs=0.06)


def test_a_half_closed_hand_is_half_an_answer() -> None:
    assert [openness(curl) for curl in (0.0, 0.25, 0.5, 0.75, 1.0)] == [1.0, 1.0, 0.5, 0.0, 0.0]


def test_the_file_keeps_the_networks(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    nets: dict[str, Network] = {s: initial(len(layers), rng) for s, layers in LAYERS_OF.items()}
    save_networks(tmp_path / "hands.npz", nets)
    stored = load_networks(tmp_path / "hands.npz")
    x = rng.standard_normal((4, SIZE, SIZE, 4)).astype(np.float32)
    assert stored["both"].logit(x) == pytest.approx(nets["both"].logit(x), rel=0.02, abs=0.02)
    (tmp_path / "broken.npz").write_bytes(b"PK")
    save_networks(tmp_path / "other.npz", nets | {"depth": initial(3, rng)})
    for name in ("broken.npz", "missing.npz", "other.npz"):
        with pytest.raises(DataError, match="train-hands"):
            load_networks(tmp_path / name)


def test_the_shipped_model_fits_this_version() -> None:
    for sight, net in load_networks().items():
        widths = tuple(w.shape[1] for w in net.weight[: len(KERNELS)])
        assert [w.shape for w in net.weight] == shapes(len(LAYERS_OF[sight]), widths, net.weight[-2].shape[1])
        assert all(np.isfinite(w).all() for w in net.weight) and net.scale > 0
