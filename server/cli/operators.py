"""``teleop operators``: profiles of the people who drive: list, show, learn, set, remove."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from teleop.profiles import ProfileStore

operators_app = typer.Typer(
    name="operators",
    help="Profiles of operators: bone lengths, skin colour, handedness, thresholds. Choose one with --operator NAME.",
    no_args_is_help=True,
)

Name = Annotated[str, typer.Argument(help="The operator's name; case does not matter.")]
Config = Annotated[Path | None, typer.Option(metavar="FILE", help="TOML file with settings.")]
Handed = Annotated[
    bool | None,
    typer.Option("--left-handed/--right-handed", help="Left-handed operators swap the roles of arms and hands."),
]


def _store(config: Path | None) -> ProfileStore:
    from server.settings import load_settings
    from teleop.profiles import ProfileStore

    return ProfileStore(load_settings(config).operators)


@operators_app.command("list")
def list_operators(config: Config = None) -> None:
    """Names of all operators, one per line."""
    store = _store(config)
    names = store.names()
    for name in names:
        typer.echo(name)
    if not names:
        typer.echo(f"no operators in {store.folder}; 'teleop operators learn NAME SESSION' makes one", err=True)


@operators_app.command("show")
def show_operator(name: Name, config: Config = None) -> None:
    """One profile as JSON."""
    typer.echo(json.dumps(_store(config).load(name).model_dump(mode="json"), indent=1))


@operators_app.command("remove")
def remove_operator(name: Name, config: Config = None) -> None:
    """Forget somebody."""
    _store(config).remove(name)
    typer.echo(f"removed {name}")


@operators_app.command("set")
def set_operator(
    name: Name,
    handed: Handed = None,
    threshold: Annotated[
        list[str] | None, typer.Option("--threshold", metavar="PATH=NUMBER", help="Own value, such as task.T1_deg=10.")
    ] = None,
    drop: Annotated[list[str] | None, typer.Option(metavar="PATH", help="Own value to forget.")] = None,
    config: Config = None,
) -> None:
    """Change a profile, or begin one."""
    from teleop.config import OperatorConfig
    from teleop.profiles import ProfileError

    store = _store(config)
    try:
        tree = store.load(name).model_dump(mode="python")
    except ProfileError:
        if name in store.names():
            raise
        tree = OperatorConfig().model_dump(mode="python") | {"name": name}
    if handed is not None:
        tree["handedness"] = "left" if handed else "right"
    for text in threshold or ():
        path, _, value = text.partition("=")
        try:
            tree["thresholds"][path.strip()] = float(value)
        except ValueError:
            raise typer.BadParameter(f"'{text}' is not PATH=NUMBER, such as task.T1_deg=10") from None
    for path in drop or ():
        tree["thresholds"].pop(path, None)
    profile = _checked(tree)
    store.save(profile)
    typer.echo(f"saved {profile.name} in {store.folder}")


def _checked(tree: dict[str, object]):  # type: ignore[no-untyped-def]
    """The profile, once it is sure that it fits the settings."""
    from pydantic import ValidationError

    from server.refusals import explain
    from teleop.config import OperatorConfig, TeleopConfig
    from teleop.profiles import ProfileError

    try:
        TeleopConfig.model_validate({"operator": tree})
        return OperatorConfig.model_validate(tree)
    except ValidationError as error:
        raise ProfileError(explain(error, TeleopConfig)) from error


@operators_app.command("learn")
def learn_operator(
    name: Name,
    source: Annotated[str, typer.Argument(help="Recording, RGB-D folder or sensor in which only they are seen.")],
    handed: Handed = None,
    frames: Annotated[int, typer.Option(min=30, max=100_000, help="Frames to look at, at most.")] = 600,
    config: Config = None,
) -> None:
    """Measure bone lengths and skin colour in a session and keep them under NAME; own thresholds stay as they were."""
    from server.cli.operators_run import learn
    from server.cli.progress import frame_progress
    from server.settings import load_settings
    from teleop.profiles import ProfileError, ProfileStore

    settings = load_settings(config)
    store = ProfileStore(settings.operators)
    with frame_progress("looking", frames) as advance:
        profile = learn(
            name, source, "left" if handed else None if handed is None else "right", frames, settings, advance
        )
    try:
        old = store.load(name)
    except ProfileError:
        pass
    else:
        profile = profile.model_copy(
            update={"thresholds": old.thresholds, "handedness": profile.handedness or old.handedness}
        )
    store.save(profile)
    bones = ", ".join(f"{bone} {length_m:.3f} m" for bone, length_m in profile.bones_m.items())
    seen = "no colour" if profile.skin is None else f"skin Cb {profile.skin[0]:.0f}, Cr {profile.skin[1]:.0f}"
    typer.echo(f"saved {profile.name}: {bones}; {seen}")
