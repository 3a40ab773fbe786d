"""A servo-driven arm that is not where it was told to be: encoder, backlash, zero and length errors, noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from robot_sim.errors import RobotError
from robot_sim.kinematics import PitchArm
from robot_sim.kinematics.chain import Chain
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.studies.config import PlantletStudyConfig


@dataclass(frozen=True, slots=True, eq=False)
class ServoModel:
    """One arm's errors. resolution_rad: encoder step. backlash, offset, noise: (n,) rad, noise as sigma.

    length_m: errors of (d1, a1, a2, a3, d5, tool).
    joint = quantised command + offset - backlash / 2 * direction + noise.
    """

    arm: PitchArm
    resolution_rad: float
    backlash_rad: FloatArray
    offset_rad: FloatArray
    noise_rad: FloatArray
    length_m: FloatArray

    @property
    def chain(self) -> Chain:
        """The arm as it is built, length errors included."""
        return built_chain(self.arm, self.length_m)

    def scaled(self, factor: float) -> ServoModel:
        """All errors but the encoder's, times factor."""
        return replace(
            self,
            backlash_rad=self.backlash_rad * factor,
            offset_rad=self.offset_rad * factor,
            noise_rad=self.noise_rad * factor,
            length_m=self.length_m * factor,
        )

    def without_noise(self) -> ServoModel:
        """The repeatable part alone."""
        return replace(self, noise_rad=np.zeros_like(self.noise_rad))

    def quantised(self, q_rad: FloatArray) -> FloatArray:
        """The command in whole encoder steps."""
        return np.round(q_rad / self.resolution_rad) * self.resolution_rad

    def joints(self, q_rad: FloatArray, direction: FloatArray, noise: FloatArray) -> FloatArray:
        """Where the joints stop for a command, the sign of the last motion, unit noise; all (..., n)."""
        stuck = self.quantised(q_rad) + self.offset_rad - 0.5 * self.backlash_rad * np.sign(direction)
        return stuck + self.noise_rad * noise

    def tool_m(self, q_rad: FloatArray, direction: FloatArray, noise: FloatArray) -> FloatArray:
        """Gripping point (N, 3) for commands (N, n)."""
        return self.chain.forward(np.atleast_2d(self.joints(q_rad, direction, noise)))[:, :3, 3]


def built_chain(arm: PitchArm, length_m: FloatArray) -> Chain:
    """The arm's chain with errors (6,) added to (d1, a1, a2, a3, d5, tool)."""
    fixed = arm.chain.fixed.copy()
    fixed[0, 2, 3] += length_m[0]
    for i, error in ((1, length_m[1]), (2, length_m[2]), (3, length_m[3])):
        fixed[i, 0, 3] += error
    # d5 runs along the last joint's axis, and so does the tool
    fixed[-1, 2, 3] += length_m[4] + length_m[5]
    return replace(arm.chain, fixed=fixed)


def draw_errors(arm: PitchArm, study: PlantletStudyConfig, rng: np.random.Generator) -> ServoModel:
    """A random arm with the configured error sizes and no noise yet."""
    n = arm.chain.n
    return ServoModel(
        arm,
        2 * np.pi / study.encoder_counts,
        np.full(n, np.radians(study.backlash_deg)),
        np.radians(study.offset_deg) * rng.standard_normal(n),
        np.zeros(n),
        study.length_m * rng.standard_normal(6),
    )


def tip_errors(
    model: ServoModel, targets: FloatArray, commands: FloatArray, directions: FloatArray, noise: FloatArray
) -> FloatArray:
    """Errors (K, R, 3) in m at K targets (K, 3): commands and directions (K, n), unit noise (K, R, n)."""
    k, r, n = noise.shape
    q = np.repeat(commands[:, None], r, axis=1).reshape(-1, n)
    d = np.repeat(directions[:, None], r, axis=1).reshape(-1, n)
    return model.tool_m(q, d, noise.reshape(-1, n)).reshape(k, r, 3) - targets[:, None]


def share_within(errors_m: FloatArray, tolerance_m: float) -> float:
    """Share of errors (..., 3) whose x, y and z all lie within the tolerance (the source's 3.1)."""
    return float((np.abs(errors_m) <= tolerance_m).all(axis=-1).mean())


def fit_errors(
    model: ServoModel,
    study: PlantletStudyConfig,
    targets: FloatArray,
    commands: FloatArray,
    directions: FloatArray,
    rng: np.random.Generator,
) -> ServoModel:
    """Noise and overall scale such that plain control puts the source's share of end points within the tolerance.

    First the noise gets study.random_ratio of the tip's error variance, then everything but the encoder is scaled by
    bisection. Raises RobotError when the encoder alone already misses the share.
    """
    noise = rng.standard_normal((len(commands), 4000, model.arm.chain.n))
    still = tip_errors(model, targets, commands, directions, noise[:, :1] * 0)
    unit = replace(model, noise_rad=np.full(model.arm.chain.n, 1e-4))
    spread = tip_errors(unit, targets, commands, directions, noise) - tip_errors(
        unit.without_noise(), targets, commands, directions, noise[:, :1]
    )
    ratio = study.random_ratio
    sigma = 1e-4 * np.sqrt(ratio / (1 - ratio) * float((still**2).mean()) / float((spread**2).mean()))
    start = replace(model, noise_rad=np.full(model.arm.chain.n, sigma))
    low, high = 0.0, 50.0
    if (
        share_within(tip_errors(start.scaled(0.0), targets, commands, directions, noise), study.tolerance_m)
        < study.source_share
    ):
        raise RobotError("the encoder's steps alone miss the tolerance; raise encoder_counts")
    for _ in range(40):
        mid = 0.5 * (low + high)
        e = tip_errors(start.scaled(mid), targets, commands, directions, noise)
        low, high = (mid, high) if share_within(e, study.tolerance_m) >= study.source_share else (low, mid)
    return start.scaled(low)
