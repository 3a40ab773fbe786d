"""What a person is like: the numbers a body is shaped by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Shape:
    """female: 0 man .. 1 woman. age: 0 (25 years) .. 1 (90 years). muscle: 0..1.

    descent: african, asian, caucasian; sum 1.
    """

    height_m: float = 1.76
    mass_kg: float = 74.0
    female: float = 0.0
    age: float = 0.1
    muscle: float = 0.5
    descent: tuple[float, float, float] = (1 / 3, 1 / 3, 1 / 3)


def random_shape(rng: np.random.Generator) -> Shape:
    """An adult of 150-200 cm and 42-110 kg; height and body mass index roughly as adults have them."""
    female = float(np.clip(rng.normal(rng.integers(0, 2), 0.12), 0, 1))
    height = float(np.clip(rng.normal(1.77 - 0.13 * female, 0.08), 1.50, 2.00))
    bmi = float(np.clip(rng.gamma(22.0, 1.12), 17.0, 36.0))
    mass = float(np.clip(bmi * height**2, 42.0, 110.0))
    a, b, c = rng.dirichlet((0.7, 0.7, 0.7))
    age = float(rng.uniform(0.0, 0.75) ** 1.3)
    return Shape(height, mass, female, age, float(rng.uniform(0.15, 0.9)), (float(a), float(b), float(c)))
