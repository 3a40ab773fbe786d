"""Arm kinematics against roboticstoolbox-python in one run: time per pose and agreement."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable

import numpy as np

from robot_sim.arms.plantlet import plantlet_arm
from robot_sim.arms.rb03 import grape_arm
from robot_sim.arms.tomato import tomato_arm
from robot_sim.kinematics import solve_dls

POSES = 20_000
SINGLE = 300
THEIRS = 400
THEIRS_IK = 60


def batch_us(run: Callable[[], object], count: int, repeats: int = 15) -> tuple[float, float, float]:
    """Percentiles 50, 95, 99 of the time per pose in us over repeated batches of count poses."""
    run()
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        run()
        times.append((time.perf_counter() - began) / count * 1e6)
    p50, p95, p99 = np.percentile(times, [50, 95, 99])
    return float(p50), float(p95), float(p99)


def each_us(run: Callable[[int], object], count: int) -> tuple[float, float, float]:
    """The same for single calls, run(k) for k < count."""
    run(0)
    times = []
    for k in range(count):
        began = time.perf_counter()
        run(k)
        times.append((time.perf_counter() - began) * 1e6)
    p50, p95, p99 = np.percentile(times, [50, 95, 99])
    return float(p50), float(p95), float(p99)


def _show(name: str, p: tuple[float, float, float], beside: float | None = None) -> None:
    times = f"{beside / p[0]:9.0f} x" if beside is not None else ""
    print(f"{name:<46}{p[0]:>11.2f}{p[1]:>11.2f}{p[2]:>11.2f}  {times}")


def main() -> None:
    """Print the table; the last column is the toolbox's median over ours."""
    rng = np.random.default_rng(0)
    arm = grape_arm()
    q = rng.uniform(arm.chain.lower, arm.chain.upper, (POSES, 6))
    T = arm.chain.forward(q)
    theirs = None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import roboticstoolbox as rtb
        h = np.pi / 2
        rows = [(0, 0, 0), (-h, arm.a1_m, 0), (0, arm.a2_m, 0), (-h, arm.a3_m, arm.d4_m), (h, 0, 0), (-h, 0, 0)]
        theirs = rtb.DHRobot([rtb.RevoluteMDH(alpha=al, a=a, d=d) for al, a, d in rows], tool=arm.T_last_tool)
    except ImportError:
        print("roboticstoolbox-python (extra dev) is not installed: our figures alone")
    print(f"{'us per pose':<46}{'p50':>11}{'p95':>11}{'p99':>11}  toolbox / ours")
    fk = jac = lm = None
    if theirs is not None:
        fk = each_us(lambda k: theirs.fkine(q[k]), THEIRS)
        jac = each_us(lambda k: theirs.jacob0(q[k]), THEIRS)
        goals = [theirs.fkine(v) for v in q[:THEIRS_IK]]
        lm = each_us(lambda k: theirs.ikine_LM(goals[k], seed=0), THEIRS_IK)
        _show("toolbox fkine", fk)
        _show("toolbox jacob0", jac)
        _show("toolbox ikine_LM", lm)
    _show(f"forward, {POSES} poses", batch_us(lambda: arm.chain.forward(q), POSES), fk and fk[0])
    _show("forward, one pose a call", each_us(lambda k: arm.chain.forward(q[k]), SINGLE), fk and fk[0])
    _show(f"Jacobian, {POSES} poses", batch_us(lambda: arm.chain.jacobian(q), POSES), jac and jac[0])
    _show(f"closed-form inverse, 6 joints, {POSES} poses", batch_us(lambda: arm.inverse_batch(T), POSES), lm and lm[0])
    _show("closed-form inverse, 6 joints, one a call", each_us(lambda k: arm.inverse(T[k]), SINGLE), lm and lm[0])
    dls = each_us(lambda k: solve_dls(arm.chain, T[k], np.zeros(6)), 200)
    _show("damped least squares, 6 joints, one a call", dls, lm and lm[0])
    for other in (plantlet_arm(), tomato_arm()):
        poses = other.chain.forward(rng.uniform(other.chain.lower, other.chain.upper, (POSES, 5)))
        _show(f"closed-form inverse, {other.chain.name}", batch_us(lambda o=other, p=poses: o.inverse_batch(p), POSES))
    if theirs is not None:
        ours = np.array([arm.chain.forward(v) for v in q[:200]])
        gap = np.abs(ours - np.array([theirs.fkine(v).A for v in q[:200]])).max()
        print(f"largest difference to the toolbox's forward kinematics: {gap:.1e}")
    batch = arm.inverse_batch(T)
    print(f"largest residual of the inverse: {batch.residual_m.max():.1e} m, {batch.residual_rad.max():.1e} rad")
