"""The sensor model against its published figures."""

import numpy as np
import pytest

from teleop.frames import Camera
from teleop.people.sensor import SensorModel, sense


def wall(z_m):
    return np.full((480, 640), z_m, np.float32)


@pytest.mark.parametrize("z_m", [1.0, 2.0, 3.0])
def test_axial_noise_grows_as_published(z_m):
    reading = sense(wall(z_m), Camera(), np.random.default_rng(1), SensorModel(quantised=False))
    sigma = 0.0012 + 0.0019 * (z_m - 0.4) ** 2
    d = reading.depth_mm[reading.depth_mm > 0] / 1000.0
    assert d.std() == pytest.approx(sigma, rel=0.1)
    assert d.mean() == pytest.approx(z_m, abs=0.001)


def test_depth_comes_in_disparity_steps():
    reading = sense(wall(2.5), Camera(), np.random.default_rng(1))
    values = np.unique(reading.depth_mm[reading.depth_mm > 0])
    assert len(values) < 12
    assert np.median(np.diff(values)) == pytest.approx(18, abs=2)


@pytest.mark.parametrize(("mirrored", "side"), [(False, -1), (True, 1)])
def test_the_shadow_is_as_wide_as_the_baseline_says_and_on_one_side(mirrored, side):
    camera = Camera(mirrored=mirrored)
    depth = wall(3.5)
    depth[:, 300:360] = 1.5
    model = SensorModel(lateral_px=0.0, axial=0.0, quantised=False)
    row = sense(depth, camera, np.random.default_rng(1), model).depth_mm[100]
    left, right = (row[200:300] == 0).sum(), (row[360:460] == 0).sum()
    width = camera.depth.fx * 0.075 * (1 / 1.5 - 1 / 3.5)
    shaded, lit = (left, right) if side < 0 else (right, left)
    assert shaded == pytest.approx(width, abs=2)
    assert lit <= 1


def test_nothing_gives_nothing_and_out_of_range_gives_nothing():
    for z in (np.inf, 0.3, 9.0):
        assert not sense(wall(z), Camera(), np.random.default_rng(1)).depth_mm.any()


def test_the_source_says_whose_surface_was_read():
    depth = wall(np.inf)
    depth[100:300, 200:400] = 2.0
    depth[100:300, 300:400] = 3.0
    model = SensorModel(axial=0.0, quantised=False, base_m=0.0)
    reading = sense(depth, Camera(), np.random.default_rng(4), model)
    read = reading.depth_mm > 0
    assert np.allclose(depth.ravel()[reading.source[read]] * 1000, reading.depth_mm[read], atol=1)
    # Lateral noise makes the outline ragged.
    assert (read != np.isfinite(depth)).sum() > 100


def test_the_same_seed_reads_the_same():
    a, b = (sense(wall(2.0), Camera(), np.random.default_rng(9)).depth_mm for _ in range(2))
    assert (a == b).all()
