"""The mask: pixels that agree in depth with one of the cells round them, and lie above the floor."""

import numpy as np

from teleop.body.mask import grow_mask

STEP, JUMP_M = 4, 0.07


def test_mask_follows_depth_and_cuts_below_the_floor_line() -> None:
    depth = np.full((16, 16), 2000, np.uint16)
    depth[:, 8:] = 3000
    grid = np.ascontiguousarray(depth[::4, ::4])
    labels = np.where(grid == 2000, 0, 1).astype(np.int32)
    free = np.array([0.0, 0.0, 0.0, 1.0], np.float32)
    only_first = np.array([True, False])
    mask, area, box = grow_mask(depth, labels, only_first, grid, 4, 0.07, free)
    assert (mask == (depth == 2000)).all()
    assert area == 128 and box == (0, 0, 8, 16)
    # height = 1 - v / 8 at 2 m: rows from 8 on are floor
    cut, area, box = grow_mask(depth, labels, only_first, grid, 4, 0.07, np.array([0.0, -1 / 16, 0.0, 1.0], np.float32))
    assert cut[:8, :8].all() and not cut[8:].any()
    assert area == 64 and box == (0, 0, 8, 8)
    nothing = grow_mask(depth, labels, np.zeros(2, bool), grid, 4, 0.07, free)
    assert nothing[1] == 0 and not nothing[0].any()


def by_the_letter(depth: np.ndarray, labels: np.ndarray, members: np.ndarray, floor_row: np.ndarray) -> np.ndarray:
    """Every pixel asked by itself, every cell round it looked at."""
    grid = depth[::STEP, ::STEP].astype(int)
    mask = np.zeros(depth.shape, bool)
    for v, u in np.ndindex(*depth.shape):
        d = int(depth[v, u])
        height_m = d * 1e-3 * (floor_row[0] * u + floor_row[1] * v + floor_row[2]) + floor_row[3]
        for r in range(max(0, v // STEP - 1), min(len(grid), v // STEP + 2)):
            for c in range(max(0, u // STEP - 1), min(grid.shape[1], u // STEP + 2)):
                limit = int(1000 * JUMP_M * max(1.0, (grid[r, c] * 1e-3) ** 2 / 4))
                chosen = labels[r, c] >= 0 and members[labels[r, c]]
                mask[v, u] |= bool(chosen and d > 0 and abs(d - grid[r, c]) < limit and height_m > 0)
    return mask


def test_mask_is_what_it_says_where_arms_are_before_the_chest() -> None:
    rng = np.random.default_rng(3)
    for width in (41, 48):
        # a chest, an arm half a metre before it, noise that reaches from one to the other, holes
        depth = rng.normal(2000, 30, (37, width))
        depth[10:20, 5:30] = rng.normal(1500, 30, (10, 25))
        depth[rng.random(depth.shape) < 0.2] = rng.uniform(1300, 2300)
        depth[rng.random(depth.shape) < 0.1] = 0
        depth_mm = depth.astype(np.uint16)
        labels = rng.integers(-1, 3, depth_mm[::STEP, ::STEP].shape).astype(np.int32)
        members = np.array([True, False, True])
        floor_row = np.array([0.001, -0.02, 0.3, 0.35], np.float32)
        grid_mm = np.ascontiguousarray(depth_mm[::STEP, ::STEP])
        mask, area, box = grow_mask(depth_mm, labels, members, grid_mm, STEP, JUMP_M, floor_row)
        wanted = by_the_letter(depth_mm, labels, members, floor_row)
        np.testing.assert_array_equal(mask, wanted)
        rows, columns = np.flatnonzero(wanted.any(axis=1)), np.flatnonzero(wanted.any(axis=0))
        assert area == wanted.sum() > 100
        assert box == (columns[0], rows[0], columns[-1] + 1, rows[-1] + 1)
