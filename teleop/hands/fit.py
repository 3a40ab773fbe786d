"""Fit the hand classifier on rendered people: ``python -m teleop.hands.fit``.

Random poses, palms and lights of ``teleop.people.sampling``; training and test people are disjoint. The joints are
the true ones with white noise, about what the tracker leaves. Writes ``weights.py`` and prints a table.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np
import numpy.typing as npt
from rich.progress import track

from teleop.config.intent import HandConfig
from teleop.hands import classifier
from teleop.hands.classifier import Classifier
from teleop.hands.features import features, hand_mask
from teleop.hands.paper import skin_ratio
from teleop.hands.view import hand_view
from teleop.intent_types import SIDES
from teleop.joints import JOINT_INDEX
from teleop.people.sampling import SampleSpec, sample_frame
from teleop.skeleton import Skeleton

Array = npt.NDArray[np.float64]
FIRST_SEED: Final = 60_000
JOINT_NOISE_M: Final = 0.017
DRAWS: Final = 3
"""Noisy copies of the joints per hand."""
OPEN_CURL, FIST_CURL = 0.15, 0.85
NEAR_M, FAR_M = 1.4, 3.5
RIDGE: Final = 30.0


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """x: (n, features). y: (n,) 1 open, 0 fist. ratio: (n,) skin ratio of the source's rule. offered: hands shown."""

    x: Array
    y: Array
    ratio: Array
    offered: int


def collect(split: Literal["train", "test"], frames: int, config: HandConfig) -> Samples:
    """Features of all hands, open or closed, that can be seen in ``frames`` rendered frames."""
    x, y, ratio, offered = [], [], [], 0
    for number in track(range(frames), f"rendering {split}", transient=True):
        size = (640, 480) if number % 3 else (320, 240)
        spec = SampleSpec(split, *size, room=number % 2 == 0, color=True)
        rendered = sample_frame(FIRST_SEED + number, spec)
        rng = np.random.default_rng(number)
        for side, curl in zip(SIDES, rendered.curl, strict=True):
            if not rendered.visible[JOINT_INDEX[f"hand_{side}"]] or OPEN_CURL <= curl <= FIST_CURL:
                continue
            for _ in range(DRAWS):
                noisy = rendered.joints_m + rng.normal(0, JOINT_NOISE_M, (20, 3))
                skeleton = Skeleton(0, noisy, np.ones(20))
                view = hand_view(rendered.frame, skeleton, side, config)
                if view is None or not NEAR_M < view.z_m < FAR_M:
                    continue
                offered += 1
                mask = hand_mask(view, config)
                if mask is None:
                    continue
                x.append(features(view, mask, config))
                y.append(float(curl < OPEN_CURL))
                area = skin_ratio(rendered.frame, skeleton, side, config)
                ratio.append(np.nan if area is None else area)
    return Samples(np.array(x), np.array(y), np.array(ratio), offered)


def fit(samples: Samples, color: bool) -> Classifier:
    """Ridge-regularised logistic regression."""
    from scipy.optimize import minimize

    used = classifier.columns(color)
    mean, deviation = samples.x[:, used].mean(axis=0), samples.x[:, used].std(axis=0) + 1e-9
    a = classifier.expand(samples.x[:, used], mean, deviation)
    sign = np.where(samples.y == 1.0, 1.0, -1.0)

    def loss(w: Array) -> tuple[float, Array]:
        margin = sign * (a @ w)
        penalty = RIDGE * np.concatenate([[0.0], w[1:]])
        gradient = a.T @ (-sign / (1.0 + np.exp(np.clip(margin, -500, 500)))) + penalty
        return float(np.logaddexp(0.0, -margin).sum() + 0.5 * penalty @ w), gradient

    weight = minimize(loss, np.zeros(a.shape[1]), jac=True, method="L-BFGS-B", options={"maxiter": 2000}).x
    return Classifier(used, mean, deviation, weight)


def table(fitted: dict[str, Classifier], samples: Samples, config: HandConfig) -> str:
    """Accuracy of the classifiers and of the source's rule on the same hands, as Markdown."""
    lines = ["| rule | hands decided | right of those decided |", "|---|---|---|"]
    truth = samples.y == 1.0
    for name, model in fitted.items():
        z = model.logit(samples.x)
        decided = np.abs(z) >= config.decide_margin
        right = ((z > 0) == truth)[decided].mean()
        lines.append(f"| {name} | {100 * decided.sum() / samples.offered:.1f} % | {100 * right:.1f} % |")
    known = ~np.isnan(samples.ratio)
    for ratio in (0.8, config.ratio):
        right = ((samples.ratio > ratio) == truth)[known].mean()
        lines.append(f"| source, ratio {ratio:g} | {100 * known.sum() / samples.offered:.1f} % | {100 * right:.1f} % |")
    return "\n".join(lines)


def source_text(fitted: dict[str, Classifier], frames: int) -> str:
    """The module that holds the weights."""
    lines = [f'"""Weights of the hand classifier, made by ``python -m teleop.hands.fit --frames {frames}``."""', ""]
    for name, model in fitted.items():
        lines.append(f"{name}: dict[str, tuple[float, ...]] = {{")
        for key in ("mean", "deviation", "weight"):
            numbers = "".join(f"        {value:.6g},\n" for value in getattr(model, key))
            lines.append(f'    "{key}": (\n{numbers}    ),')
        lines.append("}")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Render, fit, test, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=900, help="rendered frames to train on")
    parser.add_argument("--test-frames", type=int, default=400, help="rendered frames of other people to test on")
    parser.add_argument("--output", type=Path, default=Path(__file__).with_name("weights.py"))
    options = parser.parse_args()
    config = HandConfig()
    samples = collect("train", options.frames, config)
    fitted = {"WITH_COLOR": fit(samples, True), "DEPTH_ONLY": fit(samples, False)}
    options.output.write_text(source_text(fitted, options.frames), encoding="utf-8")
    print(table(fitted, collect("test", options.test_frames, config), config))


if __name__ == "__main__":
    main()
