"""Making and judging the hand model: samples, training, calibration, comparison with the source's rule."""
