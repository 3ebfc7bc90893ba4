"""Options that choose a controller or a run, and a context that prints errors of the connection."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

import click

from yarclang.cli.parameter import ParamType

if TYPE_CHECKING:
    from yarclang.runtime.session import Leash

F = TypeVar("F", bound=Callable[..., Any])

SIM = "sim"
"""Value of --to for a simulator that the command starts itself."""

_SHAPE = re.compile(
    r"tcp://(?:\[(?P<six>[^\[\]]*)\]|(?P<host>[^\[\]:/@?#\s]*))(?::(?P<port>[^:/]*))?/?", re.ASCII
)
_SIX = re.compile(r"[0-9a-f:.]*:[0-9a-f:.]*(?:%[\w.-]+)?", re.ASCII | re.IGNORECASE)
_LABEL = r"[a-z0-9_][a-z0-9_-]{0,62}"
_HOST = re.compile(rf"(?=.{{1,253}}$){_LABEL}(?:\.{_LABEL})*\.?", re.ASCII | re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Address:
    """Address of a controller.

    Attributes:
        host: host name or IP address.
        port: TCP port.
        leash: clock of a simulator in this process; simulated time waits for the simulator's client. None for
            another controller.
    """

    host: str
    port: int
    leash: Leash | None = field(default=None, compare=False, repr=False)

    def __str__(self) -> str:
        """Format the address as on a command line."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"tcp://{host}:{self.port}"


def _port() -> int:
    """Return the default port, for an address without one."""
    from yarclang.backend import backend_called
    from yarclang.robot.kinds import DEFAULT

    return backend_called(DEFAULT).port


class AddressType(ParamType["Address | None"]):
    """Parser of `tcp://HOST[:PORT]`. Returns None for `sim`, if `sim` is allowed."""

    def __init__(self, *, sim: bool = True) -> None:
        self._sim = sim
        self.name = f"{SIM}|tcp://HOST[:PORT]" if sim else "tcp://HOST[:PORT]"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Address | None:
        """Parse an address. An invalid address is a usage error."""
        if isinstance(value, Address):
            return value
        text = str(value).strip()
        if text.lower() == SIM:
            if self._sim:
                return None
            self.fail(
                "`sim` can't be used here: give the address of a running simulator, tcp://HOST:PORT",
                param,
                ctx,
            )
        if "://" not in text:
            self.fail(f"{text!r} isn't {self.name}: is tcp:// missing?", param, ctx)
        if not text.startswith("tcp://"):
            self.fail(f"{text!r}: only tcp:// addresses are supported", param, ctx)
        found = _SHAPE.fullmatch(text)
        if found is None:
            hint = ": write an IPv6 address in [ ]" if text.count(":") > 2 else ""
            self.fail(f"{text!r} isn't tcp://HOST[:PORT]{hint}", param, ctx)
        host = found["six"] if found["six"] is not None else found["host"]
        if not (_SIX if found["six"] is not None else _HOST).fullmatch(host):
            self.fail(f"{text!r}: {host!r} isn't a valid host name or IP address", param, ctx)
        port = found["port"]
        if port is None:
            return Address(host, _port())
        if not (port.isascii() and port.isdigit() and len(port) <= 5 and 0 < int(port) < 1 << 16):
            self.fail(f"{text!r}: the port must be a number from 1 to 65535", param, ctx)
        return Address(host, int(port))


def run_option(function: F, *, which: str = "The run") -> F:
    """Add --run NAME. The text `which` is the beginning of its help."""
    return click.option(
        "--run",
        "run",
        metavar="NAME",
        shell_complete=_runs,
        help=f"{which}, if there are several: its name, its robot, or its process.",
    )(function)


def controller_options(function: F) -> F:
    """Add --to and --robot, for commands that reach a controller directly, without a run."""
    from yarclang.cli.options import complete_robots

    robot = click.option(
        "--robot",
        metavar="NAME|PATH",
        shell_complete=complete_robots,
        help="With --to: the robot that the controller drives.",
    )
    to = click.option(
        "--to",
        type=AddressType(sim=False),
        metavar="tcp://HOST[:PORT]",
        help="Address the controller itself instead of a run.",
    )
    return to(robot(function))


def check_controller_options(to: Address | None, robot: str | None, run: str | None) -> None:
    """Check that --to and --robot are given together, and without --run.

    Raises:
        click.UsageError: only one of them is given, or both with --run.
    """
    if (to is None) != (robot is None):
        missing = "--robot" if robot is None else "--to"
        raise click.UsageError(f"--to and --robot belong together: {missing} is missing")
    if to is not None and run is not None:
        raise click.UsageError("--to and --run exclude each other")


@contextlib.contextmanager
def trouble_is_said() -> Iterator[None]:
    """Catch the errors Trouble and Lost in the context: print them with their remedies to standard error,
    then exit with status 1.
    """
    from yarclang.runtime.actions import Lost, Trouble

    what, remedy = "", ""
    try:
        yield
    except Trouble as trouble:
        what, remedy = trouble.what, trouble.remedy
    except Lost as lost:
        what = f"the connection was lost: {lost}"
    if not what:
        return
    click.echo(f"{click.style('error', fg='red', bold=True)}: {what}", err=True)
    if remedy:
        click.echo(f"  help: {remedy}", err=True)
    raise SystemExit(1)


def _runs(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:  # noqa: ARG001  (click's signature)
    """Return the runs whose names begin with the typed text, for completion."""
    from yarclang.runtime.actions import Trouble
    from yarclang.runtime.transports.runs import find_runs

    with contextlib.suppress(Trouble):
        return [run.name for run in find_runs() if run.name.startswith(incomplete.lower())]
    return []
