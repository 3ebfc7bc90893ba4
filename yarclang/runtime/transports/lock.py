"""The lock of a controller, for all users and sessions of this machine: only one process at a time may use
the controller.

The lock is an abstract Unix socket: a name in the kernel, without a file, which is bound as long as the
process lives. A process that finds the name taken learns from the kernel which process has bound it, and from
that process how long it has had the lock.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import ipaddress
import json
import os
import pwd
import re
import selectors
import socket
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from yarclang.runtime.transports.private import ControlError, Peer, folder, peer_of, reason_of

SPACE = "YARCLANG_LOCKS"
"""Environment variable that gives locks a name space of their own, so that tests do not disturb
each other.
"""

_PREFIX = "yarclang/lock"
_TABLE = Path("/proc/net/unix")
"""The kernel's list of Unix sockets; abstract names begin with @ there."""

_PLAIN = re.compile(r"[\w.:%-]{1,64}", re.ASCII)
"""Pattern of addresses that appear unchanged in a lock's name. Any other address is replaced by its SHA-256,
because a name has at most 107 bytes.
"""

_WAITING = 16
"""Number of callers that may wait for an answer."""

_PAUSE = 0.02
"""Pause between two answers [s], so that a process that calls endlessly can't keep the holder
from its work.
"""

_PATIENCE = 0.5
"""Longest time to wait for the answer of the process with the lock, or for a process that is just taking or
leaving the lock [s].
"""

_LONGEST = 4096
"""Longest answer [bytes]."""


@dataclass(frozen=True, slots=True)
class Holder:
    """The process that holds a lock.

    Attributes:
        peer: the process and its user, from the kernel; None if too many callers are waiting to find this
            out.
        since: when the process took the lock, as stated by the process; None if it does not answer.
        folder: folder of the process's control socket, as stated by the process.
    """

    peer: Peer | None
    since: datetime | None = None
    folder: Path | None = None

    @property
    def is_ours(self) -> bool:
        """Return True if the process belongs to our own user."""
        return self.peer is not None and self.peer.uid == os.getuid()

    @property
    def process(self) -> str:
        """Return the process in words: `process 4711`, or `a process` if its number isn't known."""
        return f"process {self.peer.pid}" if self.peer is not None and self.peer.pid else "a process"

    @property
    def facts(self) -> str:
        """Return the user, and since when the lock is held, in words; unknown facts are left out."""
        known = [] if self.peer is None else [f"user {_user_name(self.peer.uid)}"]
        if self.since is not None:
            known.append(f"since {self.since.astimezone():%Y-%m-%d %H:%M:%S}")
        return ", ".join(known)

    def __str__(self) -> str:
        return f"{self.process} ({self.facts})" if self.facts else self.process


@contextlib.contextmanager
def controller_lock(host: str, port: int) -> Iterator[None]:
    """Keep all other runs on this machine from using a controller, as long as the context lasts.

    The kernel releases the lock when the process dies, for whatever reason.

    Args:
        host: name or address of the controller; all its names and addresses count as one controller.
        port: port of the controller.

    Raises:
        ControlError: another process has the lock; the message names the process.
    """
    with contextlib.ExitStack() as stack:
        wires = [stack.enter_context(_claimed(name, host, port)) for name in _names(host, port)]
        answering = _Answering(wires)
        answering.start()
        try:
            yield
        finally:
            answering.end()


def holder_of(host: str, port: int) -> Holder | None:
    """Return the holder of a controller's lock; None if no one holds it."""
    found = (_listener(name) for name in _names(host, port))
    return next((one for one in found if one is not None), None)


def own_holders() -> tuple[Holder, ...]:
    """Return the processes of our own user that hold the lock of any controller."""
    try:
        table = _TABLE.read_text(errors="replace")
    except OSError:
        return ()
    prefix = f"@{_prefix()}/"
    names = {
        words[-1] for line in table.splitlines() if (words := line.split()) and words[-1].startswith(prefix)
    }
    found = (_listener(b"\0" + name[1:].encode(), ours=True) for name in sorted(names))
    return tuple(one for one in found if one is not None and one.is_ours)


def _prefix() -> str:
    space = re.sub(r"[^\w.-]", "_", os.environ.get(SPACE, ""), flags=re.ASCII)[:20]
    return f"{_PREFIX}/{space}"


def _names(host: str, port: int) -> list[bytes]:
    """Return the socket names of a controller's lock, one for each address of the controller, in an order
    that is the same for all processes.
    """
    names = (f"{address}:{port}" for address in _addresses(host, port))
    plain = (
        one if _PLAIN.fullmatch(one) else hashlib.sha256(one.encode(errors="replace")).hexdigest()
        for one in names
    )
    return sorted(f"\0{_prefix()}/{one}".encode() for one in plain)


def _addresses(host: str, port: int) -> set[str]:
    """Return all addresses of a host. An address of this machine is returned together with 127.0.0.1.

    127.0.0.2 and similar addresses are not treated as 127.0.0.1, because people give each simulator an
    address of its own.
    """
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        return {host.lower()}  # no process can connect to this host either, so any name will do
    addresses: set[str] = set()
    for family, _, _, _, place in found:
        address = ipaddress.ip_address(str(place[0]).partition("%")[0])
        address = getattr(address, "ipv4_mapped", None) or address
        scope = f"%{place[3]}" if len(place) > 3 and place[3] else ""
        addresses.add(f"{address}{scope}")
        if _is_here(family, place, address) and not host.startswith("127."):
            addresses.add("127.0.0.1")
    return addresses


def _is_here(
    family: int, place: tuple[object, ...], address: ipaddress.IPv4Address | ipaddress.IPv6Address
) -> bool:
    """Return True for an address of this machine. Test: packets to such an address are sent from the same
    address.
    """
    if address.is_loopback or address.is_unspecified:
        return True
    with socket.socket(family, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(place)  # a datagram socket: nothing is sent
            return bool(probe.getsockname()[0] == place[0])
        except OSError:
            return False


@contextlib.contextmanager
def _claimed(name: bytes, host: str, port: int) -> Iterator[socket.socket]:
    """Bind one socket name of a lock as long as the context lasts.

    Raises:
        ControlError: another process has the name.
    """
    until = time.monotonic() + _PATIENCE
    while (wire := _bound(name)) is None:
        # The name is bound but no process listens: its process is just taking or leaving the lock, or is
        # hostile.
        holder = _listener(name)
        if holder is not None or time.monotonic() > until:
            raise _refusal(holder or Holder(None), host, port)
        time.sleep(_PAUSE)
    with wire:
        yield wire


def _bound(name: bytes) -> socket.socket | None:
    """Return a socket that listens at a lock's name; None if the name is taken.

    Raises:
        ControlError: the kernel refuses the name.
    """
    wire = socket.socket(socket.AF_UNIX)
    try:
        wire.bind(name)
        wire.listen(_WAITING)
        wire.setblocking(False)
    except OSError as error:
        wire.close()
        if error.errno == errno.EADDRINUSE:
            return None
        raise ControlError(f"the controller's lock can't be taken: {reason_of(error)}") from None
    return wire


def _refusal(holder: Holder, host: str, port: int) -> ControlError:
    facts = f" ({holder.facts})" if holder.facts else ""
    text = f"{holder.process} on this computer already drives {host}:{port}{facts}"
    if holder.is_ours:
        return ControlError(text, "wait for its end, or stop it with `yarc stop`")
    return ControlError(text, "wait for its end, or ask its user to end it")


def _listener(name: bytes, *, ours: bool = False) -> Holder | None:
    """Return the process that listens at a lock's name; None if no process does.

    Args:
        name: the name of a lock.
        ours: True to wait for the process's own answer only if the process belongs to our own user.
    """
    with socket.socket(socket.AF_UNIX) as wire:
        wire.settimeout(_PATIENCE)
        try:
            wire.connect(name)
        except (BlockingIOError, TimeoutError):  # too many callers wait
            return Holder(None)
        except OSError:
            return None
        peer = peer_of(wire)
        if ours and peer.uid != os.getuid():
            return Holder(peer)
        try:
            return _with_facts(
                peer, wire.recv(_LONGEST)
            )  # read only once: otherwise a process could delay us by sending byte by byte
        except OSError:  # the holder is suspended, or does not answer
            return Holder(peer)


def _with_facts(peer: Peer, line: bytes) -> Holder:
    """Return the holder of a lock, with the facts that its process has sent. These facts can't be trusted:
    they appear only in messages, and only the same user's processes rely on them.
    """
    try:
        content = json.loads(line)
        since, place = datetime.fromisoformat(content["since"]), Path(content["folder"])
        since.astimezone()
    except (ValueError, TypeError, KeyError, RecursionError, OverflowError, OSError):
        return Holder(peer)
    return Holder(peer, since, place if place.is_absolute() and "\0" not in str(place) else None)


class _Answering(threading.Thread):
    """A thread that answers questions of other processes: since when this process has the lock, and where its
    control socket is.
    """

    def __init__(self, wires: list[socket.socket]) -> None:
        super().__init__(name="controller lock", daemon=True)
        try:
            place = str(folder())
        except ControlError:
            place = ""
        since = datetime.now().astimezone().isoformat(timespec="seconds")
        self._answer = json.dumps({"since": since, "folder": place}).encode() + b"\n"
        self._wires = wires
        self._ended = threading.Event()

    def run(self) -> None:
        with selectors.DefaultSelector() as calls:
            for wire in self._wires:
                calls.register(wire, selectors.EVENT_READ)
            while not self._ended.is_set():
                for call, _ in calls.select():
                    self._answer_to(call.fileobj)
                self._ended.wait(_PAUSE)

    def end(self) -> None:
        """Stop answering."""
        self._ended.set()
        for wire in self._wires:
            with contextlib.suppress(OSError):
                wire.shutdown(socket.SHUT_RDWR)
        self.join()

    def _answer_to(self, wire: object) -> None:
        assert isinstance(wire, socket.socket)
        with contextlib.suppress(OSError):  # the caller has gone, or `end` was called
            caller, _ = wire.accept()
            with caller:
                caller.setblocking(False)
                caller.sendall(self._answer)


def _user_name(uid: int) -> str:
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return str(uid)
