"""Training a small network with PyTorch: one loop for all, and what brings a network to the run time."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from teleop.body.layers import Convolution, Stack
from teleop.errors import ModelError
from teleop.training.build import Progress

Batch = tuple[npt.NDArray[Any], ...]


@dataclass(frozen=True, slots=True)
class LoopSpec:
    """steps: batches in all. rate: highest learning rate, reached after a warm-up, then falling as a cosine."""

    steps: int
    rate: float = 2e-3
    warm_up: int = 300
    weight_decay: float = 1e-4
    clip_norm: float = 5.0


def pytorch(seed: int) -> Any:
    """The module, seeded. Raises ModelError when it is not installed."""
    try:
        import torch
    except ImportError as error:
        raise ModelError(
            "training the networks needs PyTorch; install it with: pip install 'greenhouse-teleop[networks]'"
        ) from error
    torch.manual_seed(seed)
    return torch


def convolution(torch: Any, inputs: int, outputs: int, size: int, stride: int) -> Any:
    """Convolution, batch normalisation and cut at zero: one teleop.body.layers.Convolution at run time.

    Of even images with stride 2 the odd row and column of padding lie below and to the right, as at run time.
    """
    low, high = (size - stride) // 2, (size - stride + 1) // 2
    return torch.nn.Sequential(
        torch.nn.ZeroPad2d((low, high, low, high)),
        torch.nn.Conv2d(inputs, outputs, size, stride, bias=False),
        torch.nn.BatchNorm2d(outputs, momentum=0.02),
        torch.nn.ReLU(),
    )


def stacked(blocks: Sequence[Any], residual: Sequence[int] = ()) -> Stack:
    """Trained convolutions of this module in the form of the run time. residual: the numbers of those whose input is
    added to their output."""
    return Stack(tuple(_folded(block, n in residual) for n, block in enumerate(blocks)))


def _folded(block: Any, residual: bool) -> Convolution:
    _, conv, norm, _ = block
    scale = norm.weight / (norm.running_var + norm.eps).sqrt()
    kernel = (conv.weight * scale[:, None, None, None]).permute(2, 3, 1, 0).reshape(-1, conv.out_channels)
    bias = norm.bias - norm.running_mean * scale
    return Convolution(array(kernel), array(bias), int(conv.kernel_size[0]), int(conv.stride[0]), residual)


def array(values: Any) -> npt.NDArray[np.float32]:
    """A tensor's values."""
    return np.ascontiguousarray(values.detach().float().cpu().numpy())


def dense(layer: Any) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Kernel (inputs, outputs) and bias (outputs,) of a linear layer or a convolution of one pixel."""
    return array(layer.weight.flatten(1).T), array(layer.bias)


def channels_first(images: Any) -> Any:
    """Images (N, rows, columns, channels) of the run time as PyTorch takes them; nothing is copied."""
    return images.permute(0, 3, 1, 2)


def _ahead(batches: Iterator[Batch], count: int, depth: int) -> Iterator[Batch]:
    """The first ``count`` batches, up to ``depth`` of them made ahead by another thread."""
    with ThreadPoolExecutor(1) as worker:
        coming = deque(worker.submit(next, batches) for _ in range(min(depth, count)))
        for n in range(count):
            batch = coming.popleft().result()
            if n + depth < count:
                coming.append(worker.submit(next, batches))
            yield batch


def train(
    torch: Any,
    model: Any,
    loss: Callable[..., Any],
    batches: Iterator[Batch],
    spec: LoopSpec,
    name: str,
    progress: Progress,
) -> float:
    """Fit the model's weights in place. loss(*batch) is a scalar tensor. batches: without end.

    Products are taken in bfloat16 where the processor has instructions for it, twice as fast here. Returns the mean
    loss over the last tenth of the steps.
    """
    half = bool(torch.ops.mkldnn._is_mkldnn_bf16_supported())
    model.to(memory_format=torch.channels_last).train()
    optimizer = torch.optim.AdamW(model.parameters(), lr=spec.rate, weight_decay=spec.weight_decay)
    warm_up = min(spec.warm_up, max(1, spec.steps // 4))

    def rate(step: int) -> float:
        return min(1.0, (step + 1) / warm_up) * (0.005 + 0.995 * 0.5 * (1.0 + np.cos(np.pi * step / spec.steps)))

    schedule = torch.optim.lr_scheduler.LambdaLR(optimizer, rate)
    last: list[float] = []
    for n, batch in enumerate(_ahead(batches, spec.steps, 6)):
        tensors = [torch.from_numpy(part) for part in batch]
        with torch.autocast("cpu", dtype=torch.bfloat16, enabled=half):
            value = loss(*tensors)
        optimizer.zero_grad()
        value.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), spec.clip_norm)
        optimizer.step()
        schedule.step()
        if n % 20 == 0 or n >= spec.steps - max(1, spec.steps // 10):
            now = float(value.detach())
            if not np.isfinite(now):
                raise ModelError(f"training of the {name} diverged at step {n}; use a lower learning rate")
            if n >= spec.steps - max(1, spec.steps // 10):
                last.append(now)
        progress(name, (n + 1) / spec.steps)
    model.eval()
    return float(np.mean(last))


def check_runtime(found: Sequence[Any], wanted: Sequence[Any], most: float, name: str) -> None:
    """Raise ModelError unless the run time answers what the trained network answers."""
    for ours, theirs in zip(found, wanted, strict=True):
        off = float(np.abs(np.asarray(ours) - np.asarray(theirs)).max())
        if not off <= most:
            raise ModelError(f"the run time of the {name} is off by {off:.2g} from what was trained")
