# ruff: noqa: NPY002 - inside numba kernels the legacy generator is the only one
"""Growing one randomised tree: candidate features drawn anew at every node, over many pixels (Shotton 2011).

The structure is chosen by information gain over the part labels, which also makes the best regression trees
(Girshick 2011). Large nodes choose their split from a sample of their pixels: at the top a few thousand pixels decide
as well as a million.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.features import depth_difference
from teleop.body.model import OFFSET_UNIT_M
from teleop.body.parts import N_PARTS
from teleop.training.images import Images, Pixels

BINS: Final = 24
"""Thresholds tried per feature, plus one."""


@dataclass(frozen=True, slots=True)
class TreeSpec:
    """How to grow a tree. candidates: features tried a node. offset_m: half-range of the offsets; threshold_m: of the
    thresholds. sample: pixels that choose a node's split. min_leaf: fewest pixels in a leaf."""

    depth: int = 20
    candidates: int = 150
    offset_m: float = 0.45
    threshold_m: float = 0.4
    sample: int = 4000
    min_leaf: int = 38
    min_gain: float = 0.005


@dataclass(frozen=True, slots=True, eq=False)
class Tree:
    """Nodes of one tree as in BodyModel, roots at 0. leaves numbers the leaves from 0. max_depth: of any leaf."""

    offsets: npt.NDArray[np.int16]
    thresholds_mm: npt.NDArray[np.int16]
    children: npt.NDArray[np.int32]
    leaves: npt.NDArray[np.int32]
    max_depth: int


@nb.njit(cache=True, nogil=True)
def _best_split(
    flat_mm: npt.NDArray[np.int16],
    at: npt.NDArray[np.int64],
    width: npt.NDArray[np.int32],
    sx: npt.NDArray[np.float32],
    sy: npt.NDArray[np.float32],
    part: npt.NDArray[np.uint8],
    members: npt.NDArray[np.int32],
    spec_candidates: int,
    offset_units: int,
    threshold_mm: int,
    sample: int,
    min_leaf: int,
    seed: int,
    parts: int,
    bins: int,
) -> tuple[npt.NDArray[np.int16], int, float]:
    """Offsets (4,), threshold in mm and information gain in nats of the best of the candidates; gain < 0: none."""
    np.random.seed(seed)
    n = len(members)
    used = members
    if n > sample:
        used = np.empty(sample, np.int32)
        for i in range(sample):
            # one of each of ``sample`` equal runs of the node's pixels: spread over all frames
            used[i] = members[(i * n) // sample + np.random.randint(0, n // sample)]
        n = sample
    total = np.zeros(parts, np.int64)
    for i in range(n):
        total[part[used[i]]] += 1
    parent = 0.0
    for p in range(parts):
        if total[p] > 0:
            parent -= total[p] * np.log(total[p] / n)
    best_gain = -1.0
    best = np.zeros(4, np.int16)
    best_threshold = 0
    offsets = np.zeros((1, 4), np.int16)
    values = np.empty(n, np.int32)
    edges = np.empty(bins - 1, np.int32)
    histogram = np.empty((bins, parts), np.int64)
    left = np.empty(parts, np.int64)
    for _ in range(spec_candidates):
        for k in range(4):
            offsets[0, k] = np.random.randint(-offset_units, offset_units + 1)
        if np.random.random() < 0.4:  # half the published features compare with the pixel itself
            offsets[0, 2] = 0
            offsets[0, 3] = 0
        for i in range(n):
            m = used[i]
            values[i] = depth_difference(flat_mm, at[m], width[m], sx[m], sy[m], offsets, 0)
        for b in range(bins - 1):
            r = np.random.random() * 2.0 - 1.0
            if b % 3 == 0:  # at a value that occurs, else squared spacing: fine near zero
                edges[b] = min(max(values[np.random.randint(0, n)], -6000), 6000)
            else:
                edges[b] = int(threshold_mm * r * abs(r))
        edges.sort()
        histogram[:] = 0
        for i in range(n):
            lo, hi = 0, bins - 1
            v = values[i]
            while lo < hi:  # bin b holds edges[b - 1] <= v < edges[b]
                mid = (lo + hi) // 2
                if v >= edges[mid]:
                    lo = mid + 1
                else:
                    hi = mid
            histogram[lo, part[used[i]]] += 1
        left[:] = 0
        n_left = 0
        for b in range(bins - 1):
            for p in range(parts):
                left[p] += histogram[b, p]
                n_left += histogram[b, p]
            n_right = n - n_left
            if n_left < min_leaf or n_right < min_leaf:
                continue
            child = 0.0
            for p in range(parts):
                if left[p] > 0:
                    child -= left[p] * np.log(left[p] / n_left)
                right = total[p] - left[p]
                if right > 0:
                    child -= right * np.log(right / n_right)
            gain = (parent - child) / n
            if gain > best_gain:
                best_gain = gain
                best[:] = offsets[0]
                best_threshold = edges[b]
    return best, best_threshold, best_gain


@nb.njit(cache=True, nogil=True, parallel=True)
def _split_level(
    flat_mm: npt.NDArray[np.int16],
    at: npt.NDArray[np.int64],
    width: npt.NDArray[np.int32],
    sx: npt.NDArray[np.float32],
    sy: npt.NDArray[np.float32],
    part: npt.NDArray[np.uint8],
    order: npt.NDArray[np.int32],
    begin: npt.NDArray[np.int64],
    end: npt.NDArray[np.int64],
    seeds: npt.NDArray[np.int64],
    numbers: npt.NDArray[np.int64],
    min_gain: float,
) -> tuple[npt.NDArray[np.int16], npt.NDArray[np.int32], npt.NDArray[np.int64]]:
    """Split every node of a level. Node k owns order[begin[k]:end[k]], which is reordered, left pixels first.

    numbers: candidates, offset units, threshold, sample, min_leaf, parts, bins. Returns offsets (K, 4), thresholds
    (K,) and the border (K,) between left and right, -1 for a leaf.
    """
    count = len(begin)
    offsets = np.zeros((count, 4), np.int16)
    thresholds = np.zeros(count, np.int32)
    border = np.full(count, -1, np.int64)
    for k in nb.prange(count):
        members = order[begin[k] : end[k]]
        if len(members) < 2 * numbers[4]:
            continue
        o, t, gain = _best_split(
            flat_mm,
            at,
            width,
            sx,
            sy,
            part,
            members,
            numbers[0],
            numbers[1],
            numbers[2],
            numbers[3],
            numbers[4],
            seeds[k],
            numbers[5],
            numbers[6],
        )
        if gain < min_gain:
            continue
        offsets[k] = o
        thresholds[k] = t
        one = offsets[k : k + 1]
        right = np.empty(len(members), np.int32)
        n_left = n_right = 0
        for i in range(len(members)):
            m = members[i]
            if depth_difference(flat_mm, at[m], width[m], sx[m], sy[m], one, 0) >= t:
                right[n_right] = m
                n_right += 1
            else:
                members[n_left] = m
                n_left += 1
        members[n_left:] = right[:n_right]
        if n_left > 0 and n_right > 0:
            border[k] = begin[k] + n_left
    return offsets, thresholds, border


def pixel_scales(images: Images, pixels: Pixels) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Pixels per 0.1 mm of offset (N,), across and down; across is negative for mirrored pixels."""
    frame = pixels.frame % len(images)
    unit = (images.focal_px[frame] * 1000.0 * OFFSET_UNIT_M).astype(np.float32)
    down = (unit / images.flat_mm[pixels.at].astype(np.float32)).astype(np.float32)
    return np.where(pixels.frame >= len(images), -down, down), down


def grow_tree(images: Images, pixels: Pixels, spec: TreeSpec, seed: int) -> Iterator[tuple[int, Tree | None]]:
    """Grow one tree breadth first; yields (level, None) after each level and (depth, tree) at the end.

    Cost: each level reads every pixel ``candidates`` times at most, ``sample`` a node at the top.
    """
    rng = np.random.default_rng(seed)
    across, down = pixel_scales(images, pixels)
    width = images.widths[pixels.frame % len(images)]
    order = np.argsort(pixels.at, kind="stable").astype(np.int32)
    numbers = np.array(
        [
            spec.candidates,
            round(spec.offset_m / OFFSET_UNIT_M),
            round(spec.threshold_m * 1000),
            spec.sample,
            spec.min_leaf,
            N_PARTS,
            BINS,
        ],
        np.int64,
    )
    begin, end, node = np.array([0]), np.array([len(order)]), np.array([0])
    offsets, thresholds, children = [np.zeros((1, 4), np.int16)], [np.zeros(1, np.int16)], [np.zeros(1, np.int32)]
    nodes, level = 1, 0
    while len(begin):
        if level < spec.depth:
            seeds = rng.integers(0, 2**31 - 1, len(begin))
            o, t, border = _split_level(
                images.flat_mm,
                pixels.at,
                width,
                across,
                down,
                pixels.part,
                order,
                begin,
                end,
                seeds,
                numbers,
                spec.min_gain,
            )
        else:
            o, t = np.zeros((len(begin), 4), np.int16), np.zeros(len(begin), np.int32)
            border = np.full(len(begin), -1)
        split = border >= 0
        first_child = nodes + 2 * (np.cumsum(split) - 1)
        offsets[-1][:], thresholds[-1][:] = o, np.where(split, t, np.iinfo(np.int16).max)
        children[-1][:] = np.where(split, first_child, node)
        begin, end, border = begin[split], end[split], border[split]
        begin, end = np.stack([begin, border], 1).ravel(), np.stack([border, end], 1).ravel()
        node = np.arange(nodes, nodes + len(begin))
        nodes += len(begin)
        offsets.append(np.zeros((len(begin), 4), np.int16))
        thresholds.append(np.zeros(len(begin), np.int16))
        children.append(np.zeros(len(begin), np.int32))
        level += 1
        yield level, None
    child = np.concatenate(children)
    is_leaf = child == np.arange(nodes)
    leaves = np.where(is_leaf, np.cumsum(is_leaf) - 1, -1).astype(np.int32)
    yield level, Tree(np.concatenate(offsets), np.concatenate(thresholds), child, leaves, level)
