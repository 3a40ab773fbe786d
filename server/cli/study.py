"""``teleop study``: the papers' experiments, each one command."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from server.cli.study_play import play

if TYPE_CHECKING:
    from robot_sim.studies.report import Progress

study_app = typer.Typer(
    name="study",
    help="Run one of the three arm studies: tables (CSV, Markdown), plots and the motion as MCAP. The motion is also "
    "kept where 'teleop serve' finds it (setting studies), for the console's page /motion.html.",
    no_args_is_help=True,
)
study_app.command()(play)

Output = Annotated[Path, typer.Option("--output", "-o", help="Folder for report, tables, plots and motion.mcap.")]
Seed = Annotated[int, typer.Option(min=0, help="Seed of everything random; the same seed gives the same tables.")]
Quick = Annotated[bool, typer.Option("--quick", help="A coarse run in seconds, to see what the study makes.")]


@contextmanager
def progress_bar() -> Iterator[Progress]:
    """A bar on standard error that the study moves."""
    from rich.console import Console
    from rich.progress import Progress as Bar

    with Bar(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=None)

        def show(what: str, done: int, total: int) -> None:
            bar.update(task, description=what, completed=done, total=total)

        yield show


def _keep_motion(name: str, folder: Path) -> str:
    """Copy the study's motion to where the server looks; what to do with it, in words."""
    import shutil

    from robot_sim.errors import RobotError
    from server.settings import load_settings

    kept = load_settings().studies
    try:
        kept.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(folder / "motion.mcap", kept / f"{name}.mcap")
    except OSError as error:
        raise RobotError(
            f"the study is in {folder}, but its motion cannot be kept in {kept}: {error.strerror}; "
            "name another folder in TELEOP_STUDIES"
        ) from None
    return f"watch it: 'teleop serve', then /motion.html?id={name}; or 'teleop study play {folder / 'motion.mcap'}'"


def _trials(asked: int | None, full: int, quick: bool) -> int:
    return asked if asked is not None else (max(10, full // 20) if quick else full)


@study_app.command()
def grape(
    output: Output = Path("out/study_grape"),
    seed: Seed = 0,
    trials: Annotated[int | None, typer.Option(min=2, max=100_000, help="Random trials (1000).")] = None,
    quick: Quick = False,
) -> None:
    """Grape picking with a six-joint arm: clamp, hold, cut; potential-field paths around the bunches."""
    from robot_sim.studies.grape import run_grape_study

    with progress_bar() as show:
        r = run_grape_study(output, seed=seed, trials=_trials(trials, 1000, quick), quick=quick, progress=show)
    typer.echo(
        f"18 trials: {r.first_successes} succeed; random trials: single {r.single_share:.1%}, "
        f"overlapping {r.overlapping_share:.1%} (source 93.3 %, 82.1 %)"
    )
    typer.echo(str(r.page))
    typer.echo(_keep_motion("grape", output))


@study_app.command()
def plantlet(
    output: Output = Path("out/study_plantlet"),
    seed: Seed = 0,
    trials: Annotated[int | None, typer.Option(min=20, max=100_000, help="Repeats of each move (1000).")] = None,
    quick: Quick = False,
) -> None:
    """Transplanting plantlets with a five-joint arm: smooth carrying, straight entry, calibration."""
    from robot_sim.studies.plantlet import run_plantlet_study

    with progress_bar() as show:
        r = run_plantlet_study(output, seed=seed, trials=_trials(trials, 1000, quick), quick=quick, progress=show)
    typer.echo(
        f"within ±0.5 mm: plain {r.plain_share:.1%} (source 90 %), compensated {r.compensated_share:.1%}; "
        f"least clearance to a bottle {r.clearance_m * 1e3:.1f} mm"
    )
    typer.echo(str(r.page))
    typer.echo(_keep_motion("plantlet", output))


@study_app.command()
def tomato(output: Output = Path("out/study_tomato"), seed: Seed = 0, quick: Quick = False) -> None:
    """Cherry-tomato arm: workspace and its voids, trajectory, redundancy."""
    from robot_sim.studies.tomato import run_tomato_study

    with progress_bar() as show:
        r = run_tomato_study(output, seed=seed, quick=quick, progress=show)
    typer.echo(
        f"fine grid: {r.fine.pockets} voids in {r.fine.samples:,} samples; {'; '.join(r.breaches) or 'no limit broken'}"
    )
    typer.echo(str(r.page))
    typer.echo(_keep_motion("tomato", output))


@study_app.command("leg-features")
def leg_features(
    output: Output = Path("out/study_leg_features"),
    seed: Seed = 0,
    seconds: Annotated[int | None, typer.Option(min=4, max=3600, help="Samples, one a second, of each (300).")] = None,
    quick: Quick = False,
) -> None:
    """Which vectors of the legs keep a steady angle: ten rendered people, through the tracker (source's table 1)."""
    from teleop.studies.leg_features import PAIRS, SOURCE_DEG2, run_leg_study

    with progress_bar() as show:
        r = run_leg_study(output, _trials(seconds, 300, quick), seed, show)
    for i, pair in enumerate(PAIRS):
        typer.echo(
            f"{pair}: tracked {r.tracked_deg2[:, i].mean():.2f} deg^2, single frames {r.single_deg2[:, i].mean():.2f}, "
            f"true joints {r.true_deg2[:, i].mean():.2f}, "
            f"source {SOURCE_DEG2[pair]:.2f}"
        )
    typer.echo(f"steadiest as tracked: {r.steadiest} (source: H-K)")
    typer.echo(str(r.page))


@study_app.command()
def mapping(output: Output = Path("out/study_mapping")) -> None:
    """Arm mapping, paper against direction: how far the robot's upper arm points from the operator's."""
    import numpy as np

    from teleop.studies.mapping_difference import run_mapping_study

    r = run_mapping_study(output)
    for name, error_deg in r.errors_deg.items():
        typer.echo(f"{name}: mean {np.nanmean(error_deg):.1f} deg, largest {np.nanmax(error_deg):.1f} deg")
    typer.echo(str(r.page))
