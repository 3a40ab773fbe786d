"""Starts everything in the right order, serves until told to stop, and stops everything in the reverse order."""

from __future__ import annotations

import errno
import logging
import os
import signal
import socket
import ssl
import sys
from collections.abc import Callable, Mapping

import uvicorn

from server.errors import ServerError
from server.reload import Read
from server.settings import Settings
from server.web_server import StoppingServer

_log = logging.getLogger(__name__)
Tell = Callable[[str], None]
Show = Callable[[Mapping[str, str]], None]
_SEND_BUFFER = 1 << 18
"""Bytes the kernel holds back for one slow client; more would only be old pictures."""

SWITCH_S = 0.0005
"""Threads take turns this often, not every 5 ms: a stop must not wait for a picture's share of Python."""


NICE = -5
"""Priority of the server's threads where the system allows it."""


def listen(settings: Settings) -> socket.socket:
    """Bind the port before anything heavy is loaded. Raises ServerError: busy, not allowed, no such address."""
    host, port = settings.host, settings.port
    try:
        family, kind, proto, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, kind, proto)
        try:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BUFFER)
            listener.bind(address)
            listener.listen(128)
        except OSError:
            listener.close()
            raise
    except socket.gaierror:
        raise ServerError(f"'{host}' is no address of this computer; use --host 127.0.0.1 or --host 0.0.0.0") from None
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise ServerError(f"port {port} is in use; stop what uses it or choose another one with --port") from None
        raise ServerError(f"cannot listen on {host} port {port}: {error.strerror}; choose another --port") from None
    return listener


def check_tls(settings: Settings) -> None:
    """Raises ServerError when certificate and key are not a pair that can be used."""
    if (settings.tls_cert is None) != (settings.tls_key is None):
        raise ServerError("--tls-cert and --tls-key belong together; give both")
    if settings.tls_cert is None or settings.tls_key is None:
        return
    for path in (settings.tls_cert, settings.tls_key):
        if not path.is_file():
            raise ServerError(f"no file {path}; --tls-cert and --tls-key take PEM files")
    try:
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(settings.tls_cert, settings.tls_key)
    except (ssl.SSLError, OSError) as error:
        why = error.reason if isinstance(error, ssl.SSLError) else error.strerror
        raise ServerError(
            f"{settings.tls_cert} and {settings.tls_key} cannot be used: {why}; both must be PEM"
        ) from None


def take_precedence() -> bool:
    """Let the robot's threads, all made after this one, run before a browser that draws on the same processor; whether
    the system allows it (root does, and a systemd unit with LimitNICE=-5)."""
    try:
        os.setpriority(os.PRIO_PROCESS, 0, min(NICE, os.getpriority(os.PRIO_PROCESS, 0)))
    except PermissionError:
        return False
    return True


def serve(read: Read, listener: socket.socket, tell: Tell, show: Show, *, new_tokens: bool = False) -> None:
    """Load, run until Ctrl-C or SIGTERM, shut down. Raises TeleopError when the source or the model is wrong.

    read: the settings, now and for a reload. show: called once with the tokens by role when they were just made.
    """
    settings = read()
    sys.setswitchinterval(SWITCH_S)
    take_precedence()
    tell("loading")
    from server.quiet import quiet_output

    with quiet_output():
        from robot_sim.link import open_robot
    from server.access.tokens import load_tokens
    from server.app import create_app
    from server.engine.engine import Engine
    from server.library import Library
    from server.opening import located, open_path
    from server.settings import bundled_recordings
    from server.stream.hub import Hub
    from teleop.body.model import load_model
    from teleop.body.tracker import BodyTracker
    from teleop.recording.repair import repair_folder
    from teleop.sources import open_source

    library = Library(settings.library, bundled_recordings(), settings.upload.recording_mb * 1_000_000)
    waits_for_sender = settings.source.lower().startswith("push:")
    if settings.source and not waits_for_sender:
        open_source(located(library, settings.source)).close()
    tell("reading the body model")
    tracker = BodyTracker(load_model(settings.model), settings.teleop.body)
    tell("building the greenhouse" if settings.drives == "pybullet:" else "calling the robot")
    with quiet_output():
        world = open_robot(settings.drives, settings.robot, settings.seed)
    tokens, shown = load_tokens(settings.access.file, renew=new_tokens)
    hub = Hub(settings.stream.max_clients, settings.stream.max_events, settings.stream.history_events)
    for line in repair_folder(settings.library):
        _log.warning(line)
    engine = Engine(settings, tracker, world, hub)
    live = None
    if settings.foxglove:
        from server.foxglove_live import FoxgloveLive

        live = FoxgloveLive(world.urdf, settings.foxglove_port, settings.recording.jpeg_quality)
        live.start()
        engine.on_moment = live.offer
    engine.start()
    try:
        if settings.source and not waits_for_sender:
            tell("compiling kernels (a minute the first time)")
            open_path(engine, library, settings.source, loop=settings.loop, record=settings.record)
        app = create_app(engine, hub, library, settings, tokens, read)
        config = uvicorn.Config(
            app,
            log_config=None,  # server.logs
            access_log=False,
            ws_per_message_deflate=False,  # pictures are compressed already, and states take longer to than to send
            ws_max_size=settings.upload.frame_kb * 1000,
            timeout_graceful_shutdown=2,
            lifespan="on",
            proxy_headers=False,  # an address that a client names itself proves nothing
            ssl_certfile=settings.tls_cert,
            ssl_keyfile=settings.tls_key,
        )
        # uvicorn raises the signal again when it is done; ending well is not an error
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: None)
        tell("")
        _log.info("serving", extra={"host": settings.host, "port": settings.port, "source": settings.source})
        if shown:
            show({role.label: token for role, token in shown.items()})
        StoppingServer(config, engine, read).run(sockets=[listener])
    finally:
        engine.stop()
        if live is not None:
            live.stop()
        _log.info("stopped")
