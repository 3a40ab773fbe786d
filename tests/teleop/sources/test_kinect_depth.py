"""Raw disparity of a Kinect v1."""

import numpy as np

from teleop.sources.kinect_depth import MAX_MM, RAW_NONE, RAW_TO_MM, mm_to_raw, raw_to_mm


def test_raw_counts_round_trip_exactly() -> None:
    raw = np.flatnonzero(RAW_TO_MM).astype(np.uint16)[None, :]
    assert raw.size > 900
    # Nearer than 585 mm (raw 502) millimetres are coarser than counts.
    far = raw[raw > 502][None, :]
    np.testing.assert_array_equal(mm_to_raw(raw_to_mm(far)), far)


def test_millimetres_round_trip_within_half_a_step() -> None:
    mm = np.arange(500, 9500, dtype=np.uint16)[None, :]
    error = np.abs(raw_to_mm(mm_to_raw(mm)).astype(float) - mm)
    # The published step of the sensor is z^2 / 35130 cm with z in cm; a half step, and a half millimetre of rounding.
    assert (error <= 0.5 * mm.astype(float) ** 2 / 342_205 * 1.03 + 1.0).all()


def test_no_reading_stays_no_reading() -> None:
    assert raw_to_mm(np.array([[RAW_NONE, 2046, 1090, 4000]], np.uint16)).max() == 0
    assert (mm_to_raw(np.array([[0, 1, 200, MAX_MM + 1, 65535]], np.uint16)) == RAW_NONE).all()


def test_the_table_agrees_with_the_published_calibration() -> None:
    # Khoshelham and Elberink 2012, Sensors 12: z = 1 / (3.33 - 0.00307 raw) m, another device: within 3 % to 4 m.
    raw = np.arange(500, 1000)
    published = 1000.0 / (3.3309495161 - 0.0030711016 * raw)
    np.testing.assert_allclose(RAW_TO_MM[raw], published, rtol=0.06)
