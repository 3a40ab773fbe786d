"""The server's settings tree: defaults, then a TOML file, then TELEOP_* variables, then flags; the last one wins."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, ValidationError
from pydantic_settings import BaseSettings, PydanticBaseSettingsSource, SettingsConfigDict

from robot_sim.config import RobotConfig
from robot_sim.scenario import load_scenario
from server.errors import SettingsError
from server.refusals import explain
from teleop.config import OperatorConfig, TeleopConfig
from teleop.config.base import Section
from teleop.config.recording import RecordingConfig
from teleop.config.sensor import SensorConfig
from teleop.profiles import ProfileStore

LOOPBACK = ("127.0.0.1", "localhost", "::1")


def default_library() -> Path:
    """Where own recordings go: $XDG_DATA_HOME/greenhouse-teleop/recordings, else under ~/.local/share."""
    base = os.environ.get("XDG_DATA_HOME")
    return (Path(base) if base else Path.home() / ".local" / "share") / "greenhouse-teleop" / "recordings"


def default_studies() -> Path:
    """Where 'teleop study' keeps motions for the console: the folder studies beside the recordings."""
    return default_library().with_name("studies")


def default_access() -> Path:
    """Where the digests of the tokens are kept: a file beside the recordings."""
    return default_library().with_name("access.json")


def default_operators() -> Path:
    """Where operator profiles lie: the folder operators beside the recordings."""
    return default_library().with_name("operators")


def bundled_recordings() -> Path:
    """The recordings that come with the project, read only: inside an installed package, else in the source tree."""
    here = Path(__file__).resolve().parent
    installed = here / "recordings"
    return installed if installed.is_dir() else here.parent / "recordings"


class StreamConfig(Section):
    """What the websocket carries."""

    state_hz: float = Field(default=30.0, ge=1.0, le=120.0, description="states sent to each client [1/s]")
    image_hz: float = Field(
        default=15.0, ge=1.0, le=60.0, description="depth or colour pictures sent to each client [1/s]"
    )
    image_width_px: int = Field(default=320, ge=80, le=1280, description="width of depth and colour pictures [px]")
    jpeg_quality: int = Field(default=80, ge=30, le=100, description="JPEG quality of all pictures")
    depth_near_m: float = Field(
        default=0.8, ge=0.1, le=5.0, description="depth drawn in the first colour of the map [m]"
    )
    depth_far_m: float = Field(
        default=4.5, ge=0.5, le=15.0, description="depth drawn in the last colour of the map [m]"
    )
    head_hz: float = Field(default=3.0, ge=0.2, le=15.0, description="head camera pictures while somebody looks [1/s]")
    head_width_px: int = Field(default=240, ge=80, le=1280, description="width of the head camera picture, 4:3 [px]")
    max_events: int = Field(
        default=500, ge=16, le=100_000, description="unsent events after which a stalled client is closed"
    )
    history_events: int = Field(default=50, ge=0, le=10_000, description="past events that a new client is told")
    max_clients: int = Field(default=64, ge=1, le=1000, description="clients of the stream at one time")


class LoopConfig(Section):
    """The engine's own pace; watchdog times belong to teleop's safety."""

    tick_hz: float = Field(
        default=30.0, ge=5.0, le=240.0, description="steps between slow frames and without frames [1/s]"
    )
    max_step_s: float = Field(default=0.1, ge=0.01, le=0.5, description="longest stretch simulated for one frame [s]")
    degraded_s: float = Field(
        default=1.0, ge=0.1, le=60.0, description="age of the last step from which /health says degraded [s]"
    )
    ledger_frames: int = Field(default=300, ge=30, le=10_000, description="frames the latency percentiles look back on")
    min_disk_mb: int = Field(
        default=500, ge=0, le=1_000_000, description="free disk space below which /ready says no [MB]"
    )
    reset_robot_on_loop: bool = Field(
        default=True, description="put the robot back to its start when a recording loops"
    )


class UploadConfig(Section):
    """Limits on what a client may send."""

    recording_mb: int = Field(default=512, ge=1, le=65536, description="largest uploaded recording [MB]")
    json_kb: int = Field(default=256, ge=4, le=16384, description="largest JSON body [kB]")
    frame_kb: int = Field(default=4096, ge=64, le=65536, description="largest pushed frame [kB]")


class AccessConfig(Section):
    """Who may do what."""

    file: Path = Field(default_factory=default_access, description="file with the digests of the tokens")
    local_role: Literal["none", "viewer", "operator", "supervisor"] = Field(
        default="operator", description="role of clients on this machine that give no token"
    )
    login_days: float = Field(default=30.0, ge=0.01, le=365.0, description="how long a browser stays logged in [d]")
    lease_idle_s: float = Field(
        default=10.0, ge=1.0, le=3600.0, description="the lease lapses when its holder is gone for so long [s]"
    )
    commands_per_s: float = Field(
        default=200.0, ge=1.0, le=10_000.0, description="commands that one address may send on average [1/s]"
    )
    command_burst: int = Field(default=400, ge=1, le=100_000, description="commands that one address may send at once")
    messages_per_s: float = Field(
        default=300.0, ge=10.0, le=10_000.0, description="messages that one client of the stream may send [1/s]"
    )
    failed_logins_per_min: int = Field(
        default=10, ge=1, le=1000, description="wrong tokens that one address may try [1/min]"
    )


class Settings(Section):
    """Everything the server can be told."""

    host: str = Field(
        default="127.0.0.1", min_length=1, description="address to listen on; beyond loopback clients need a token"
    )
    port: int = Field(default=8000, ge=1, le=65535, description="TCP port to listen on")
    source: str = Field(default="", description="source URI to start with; empty waits for POST /api/v1/sessions")
    drives: str = Field(
        default="pybullet:",
        description="the robot: pybullet: (simulation) or serial:PORT (servo controller, docs/servo_protocol.md)",
    )
    scenario: str = Field(
        default="", description="run to play: a bundled scenario's name or a TOML file; it brings robot, crop and start"
    )
    seed: int = Field(default=0, ge=0, le=2**31, description="decides the crop and how droplets fly")
    loop: bool = Field(default=True, description="start a recorded source again at its end")
    foxglove: bool = Field(default=False, description="open Foxglove's websocket on this machine (loopback)")
    foxglove_port: int = Field(default=8765, ge=0, le=65535, description="TCP port of Foxglove's websocket; 0: any")
    record: bool = Field(default=False, description="record the session to the library")
    library: Path = Field(default_factory=default_library, description="folder of own recordings")
    studies: Path = Field(default_factory=default_studies, description="folder of the motions of 'teleop study'")
    operators: Path = Field(default_factory=default_operators, description="folder of the operator profiles")
    model: Path | None = Field(default=None, description="body model file; the shipped one by default")
    allowed_origins: tuple[str, ...] = Field(
        default=(), description="web origins beside the server's own that may connect"
    )
    log_format: Literal["text", "json"] = Field(
        default="text", description="text: warnings for people; json: one object a line with everything that happens"
    )
    stream: StreamConfig = Field(default_factory=StreamConfig)
    engine: LoopConfig = Field(default_factory=LoopConfig)
    upload: UploadConfig = Field(default_factory=UploadConfig)
    access: AccessConfig = Field(default_factory=AccessConfig)
    tls_cert: Path | None = Field(default=None, description="PEM file with the certificate chain; needs tls_key")
    tls_key: Path | None = Field(default=None, description="PEM file with the certificate's private key")
    recording: RecordingConfig = Field(default_factory=RecordingConfig)
    sensor: SensorConfig = Field(default_factory=SensorConfig)
    teleop: TeleopConfig = Field(default_factory=TeleopConfig)
    robot: RobotConfig = Field(default_factory=RobotConfig)

    @property
    def is_public(self) -> bool:
        """Whether other machines can reach the server."""
        return self.host not in LOOPBACK


def load_settings(config_file: Path | None = None, flags: Mapping[str, Any] | None = None) -> Settings:
    """Read the settings. ``flags`` holds those given on the command line (None = not given).

    Raises SettingsError with one line that names the setting and its legal range, RobotError for a scenario that is
    not there or not sound.
    """
    tree = _read_toml(config_file) if config_file else {}
    settings = _validated(tree)
    given = {key: value for key, value in (flags or {}).items() if value is not None}
    settings = changed(settings, given) if given else settings
    return _with_scenario(settings) if settings.scenario else settings


def changed(settings: Settings, patch: Mapping[str, Any]) -> Settings:
    """The settings with a partial tree laid over them. Raises SettingsError, and changes nothing, when refused."""
    merged = _merge(settings.model_dump(mode="python"), patch)
    try:
        return Settings.model_validate(merged)
    except ValidationError as error:
        raise SettingsError(explain(error, Settings)) from error


def _with_scenario(settings: Settings) -> Settings:
    """The settings with robot and seed of their scenario. Raises RobotError for one that is not there or not sound."""
    if settings.drives != "pybullet:":
        raise SettingsError(f"a scenario needs the simulation, not {settings.drives}; leave out one of the two")
    if settings.robot != RobotConfig():
        raise SettingsError(f"scenario '{settings.scenario}' brings its own robot; move the settings 'robot' into it")
    scenario = load_scenario(settings.scenario)
    return settings.model_copy(update={"robot": scenario.robot_config, "seed": scenario.seed})


def with_operator(settings: Settings, name: str | None) -> Settings:
    """The settings with an operator's profile chosen by name; None or "" chooses nobody.

    Raises ProfileError for a name that is not known and SettingsError for values that do not fit.
    """
    profile = ProfileStore(settings.operators).load(name) if name else OperatorConfig()
    teleop = settings.teleop.model_dump(mode="python") | {"operator": profile.model_dump(mode="python")}
    try:
        return settings.model_copy(update={"teleop": TeleopConfig.model_validate(teleop)})
    except ValidationError as error:
        raise SettingsError(f"operator '{name}': {explain(error, TeleopConfig)}") from error


class _Layered(Settings, BaseSettings):
    """The same tree filled from the environment over the values given in code."""

    model_config = SettingsConfigDict(env_prefix="TELEOP_", env_nested_delimiter="__")

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,
        file_secret_settings: PydanticBaseSettingsSource,
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        del settings_cls, dotenv_settings, file_secret_settings
        return env_settings, init_settings


def _validated(tree: Mapping[str, Any]) -> Settings:
    try:
        return _Layered(**tree)
    except ValidationError as error:
        raise SettingsError(explain(error, Settings)) from error


def _merge(base: Mapping[str, Any], patch: Mapping[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in patch.items():
        old = merged.get(key)
        merged[key] = _merge(old, value) if isinstance(old, dict) and isinstance(value, Mapping) else value
    return merged


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise SettingsError(f"no configuration file {path}; give the path of a TOML file to --config") from None
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise SettingsError(f"{path}: {error}; it must be a TOML file") from error
