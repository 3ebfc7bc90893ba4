"""The pendant's web server, with or without TLS. It may run in the same event loop as the coordinator."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import ssl
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

import uvicorn

from yarclang.pendant.life import Life
from yarclang.pendant.seats import Attach
from yarclang.pendant.web.app import application
from yarclang.pendant.web.connection import MOST, Connection
from yarclang.pendant.web.service import Service
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble

_LAST = 2
"""Time that connections have to end when the server ends [s]."""

_QUIET = 5
"""Time after which a connection without a further request is closed [s]."""


@dataclass(frozen=True, slots=True)
class Place:
    """Address and port at which a pendant's server listens.

    Attributes:
        host: network address or host name.
        port: number of the port; 0 for any free port.
        names: further host names under which browsers may reach the server.
        certificate: file with the TLS certificate; None without TLS.
        key: file with the key of the certificate; None without TLS.
    """

    host: str
    port: int
    names: frozenset[str] = frozenset()
    certificate: Path | None = None
    key: Path | None = None


@asynccontextmanager
async def served(
    robot: Robot,
    attach: Attach,
    folder: Path,
    database: Path,
    place: Place,
    *,
    logs: Path | None = None,
    life: Life | None = None,
) -> AsyncIterator[tuple[str, str]]:
    """Serve a pendant until the context ends.

    Args:
        robot: robot of the pendant.
        attach: attaches new clients to the robot's coordinator.
        folder: folder of the project.
        database: file with users, sessions, audit trail and alarms.
        place: address and port at which to listen.
        logs: folder or file into which runs are logged; None if unknown.
        life: object that receives users' requests to end this process; None if users can't end it at the
            pendant.

    Yields:
        Two values: the URL of the pages, and the token of the one-time link by which the first user is
            created (empty if there is a user already).

    Raises:
        Trouble: the port is taken, a file can't be used, or the coordinator can't be reached.
    """
    listener = _listener(place)
    with contextlib.closing(listener):
        service = Service.opened(robot, attach, folder, database, logs=logs, life=life)
        try:
            await service.watched.start()
            server = uvicorn.Server(_config(service, place))
            server.capture_signals = contextlib.nullcontext  # type: ignore[method-assign,assignment]  # signals are the door's
            watching = asyncio.create_task(service.watched.run())
            sampling = asyncio.create_task(service.sampler.run())
            serving = asyncio.create_task(server.serve([listener]))
            port = listener.getsockname()[1]
            host = f"[{place.host}]" if ":" in place.host else place.host
            scheme = "http" if place.certificate is None else "https"
            try:
                yield f"{scheme}://{host}:{port}/", service.accounts.first
            finally:
                server.should_exit = True
                with contextlib.suppress(asyncio.CancelledError):
                    await serving
                for task in (sampling, watching):
                    task.cancel()
                    with contextlib.suppress(asyncio.CancelledError):
                        await task
        finally:
            service.backups.forget()
            await service.checks.close()
            await service.watched.stop()
            await service.alarms.close()
            await service.accounts.close()


def _listener(place: Place) -> socket.socket:
    try:
        found = socket.getaddrinfo(place.host, place.port, type=socket.SOCK_STREAM)[0]
        return socket.create_server(
            found[4][:2], family=found[0], backlog=128, dualstack_ipv6=False, reuse_port=False
        )
    except (OSError, OverflowError) as error:
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        what = f"{place.host} port {place.port} can't be listened on: {reason}"
        raise Trouble(what, "choose another --port (0 takes a free one) or --host", "") from None


def _config(service: Service, place: Place) -> uvicorn.Config:
    try:
        config = uvicorn.Config(
            application(service, place.names | {place.host}),
            log_config=None,
            access_log=False,
            lifespan="off",
            http=Connection,
            ws="websockets-sansio",
            ws_max_size=1 << 20,
            ws_ping_interval=5.0,
            ws_ping_timeout=5.0,
            server_header=False,
            date_header=False,
            proxy_headers=False,
            timeout_keep_alive=_QUIET,
            timeout_graceful_shutdown=_LAST,
            limit_concurrency=MOST,
            ssl_certfile=place.certificate,
            ssl_keyfile=place.key,
        )
        config.load()
    except (OSError, ssl.SSLError) as error:
        reason = str(error).lower()
        raise Trouble(
            f"{place.certificate} and {place.key} can't be used for TLS: {reason}",
            "name a certificate and its key in PEM form", "",
        ) from None  # fmt: skip
    return config
