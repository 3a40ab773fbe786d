"""Find an arm's repeatable errors from measured tool positions, and command it so that they cancel.

Calibration is a regularised least-squares fit (Gauss-Newton) of joint zeros, link lengths and backlash. Compensation
inverts the fitted model at the target and then picks, among the encoder steps around the answer, the best combination.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from robot_sim.kinematics.transforms import FloatArray, pose_error
from robot_sim.studies.config import PlantletStudyConfig
from robot_sim.studies.servo_model import ServoModel


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """The fitted model (no noise) and the residual's root mean square in m before and after the fit."""

    model: ServoModel
    rms_before_m: float
    rms_after_m: float


def _with(model: ServoModel, x: FloatArray) -> ServoModel:
    n = model.arm.chain.n
    return replace(model, offset_rad=x[:n], backlash_rad=x[n : 2 * n], length_m=x[2 * n :])


def calibrate(truth: ServoModel, study: PlantletStudyConfig, rng: np.random.Generator) -> Calibration:
    """Move the arm (truth) to random poses, measure the tool with gauge noise, fit; truth's numbers stay unseen."""
    n = truth.arm.chain.n
    K = study.calibration_poses
    chain = truth.arm.chain
    # poses in the half of the range where the arm works, gripper reachable with a gauge
    q = rng.uniform(np.maximum(chain.lower, -2.0), np.minimum(chain.upper, 2.0), (K, n))
    direction = rng.choice([-1.0, 1.0], (K, n))
    measured = truth.tool_m(q, direction, rng.standard_normal((K, n))) + study.gauge_m * rng.standard_normal((K, 3))
    still = np.zeros((K, n))
    blank = ServoModel(truth.arm, truth.resolution_rad, np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(6))
    # sizes one expects before measuring, wide enough not to pull the answer
    prior = np.concatenate([np.full(n, 2e-3), np.full(n, 2e-3), np.full(6, 1e-3)])
    sigma = 2e-4
    x = np.zeros(2 * n + 6)

    def predicted(at: FloatArray) -> FloatArray:
        return _with(blank, at).tool_m(q, direction, still).ravel()

    before = measured.ravel() - predicted(x)
    for _ in range(4):
        base = predicted(x)
        steps = 1e-6 * np.eye(len(x))
        J = np.stack([(predicted(x + s) - base) / 1e-6 for s in steps], axis=1)
        A = np.concatenate([J / sigma, np.diag(1 / prior)])
        b = np.concatenate([(measured.ravel() - base) / sigma, -x / prior])
        x = x + np.linalg.lstsq(A, b, rcond=None)[0]
    after = measured.ravel() - predicted(x)
    rms = [float(np.sqrt((r.reshape(-1, 3) ** 2).sum(axis=1).mean())) for r in (before, after)]
    return Calibration(_with(blank, x), rms[0], rms[1])


def compensated(model: ServoModel, q_rad: FloatArray, direction: FloatArray, search: bool = True) -> FloatArray:
    """Command (n,) that brings the fitted model's tool to where the ideal arm would have it at q_rad (n,)."""
    goal = model.arm.chain.forward(q_rad)
    chain = model.chain
    lost = model.offset_rad - 0.5 * model.backlash_rad * np.sign(direction)
    q = q_rad - lost
    for _ in range(4):
        actual = q + lost
        # the roll axis runs through the tool: five joints, so the least-squares step is the exact one
        q = q + np.linalg.lstsq(chain.jacobian(actual), pose_error(chain.forward(actual), goal), rcond=1e-6)[0]
    if not search:
        return q
    floor = np.floor(q[:4] / model.resolution_rad)
    corners = np.array([[*(floor + step), q[4] / model.resolution_rad] for step in product((0.0, 1.0), repeat=4)])
    corners *= model.resolution_rad
    miss = np.linalg.norm(chain.forward(corners + lost)[:, :3, 3] - goal[:3, 3], axis=1)
    return corners[int(np.argmin(miss))]
