"""Check that a browser's request is meant for this server, and comes from the server's own pages.

Any page in the same browser can send requests to this machine. A hostile site can also let its own host name
resolve to this machine's address (DNS rebinding); the browser then takes this server for a part of that site.
The headers reveal both attacks: Host has the name to which the browser connected, and Origin has the origin
of the page.
"""

from __future__ import annotations

import ipaddress
import re
from urllib.parse import urlsplit

HERE = frozenset({"localhost", "127.0.0.1", "::1"})
"""Names by which this machine can reach itself."""

_HOST = re.compile(
    r"(?:\[(?P<six>[0-9a-f:.]+)\]|(?P<name>[^\s:@/?#\[\]]+))(?::(?P<port>[0-9]{1,5}))?", re.ASCII
)
_PORTS = {"http": 80, "https": 443}


def is_called(host: str, port: int, names: set[str] | frozenset[str], scheme: str = "http") -> bool:
    """Return True if a Host header has one of a server's names, and the server's port.

    Args:
        host: the header.
        port: port of the connection.
        names: names and addresses in lower case.
        scheme: http or https.
    """
    found = _HOST.fullmatch(host.lower())
    if found is None or int(found["port"] or _PORTS[scheme]) != port:
        return False
    return _plain(found["six"] or found["name"].removesuffix(".")) in {_plain(name) for name in names}


def is_own(origin: str | None, host: str | None, scheme: str = "http") -> bool:
    """Return True if a page may connect, because this server has served it.

    Args:
        origin: origin of the page; None if the client isn't a page.
        host: Host header of the connection.
        scheme: http or https, of the connection.
    """
    if origin is None:
        return True
    if host is None:
        return False
    page, wanted = urlsplit(origin), urlsplit(f"//{host}")
    try:
        ports = page.port or _PORTS.get(page.scheme, 0), wanted.port or _PORTS[scheme]
    except ValueError:
        return False
    names = page.hostname, wanted.hostname
    return (
        page.scheme == scheme
        and ports[0] == ports[1]
        and (names[0] == names[1] or HERE.issuperset(name or "" for name in names))
    )


def is_loopback(host: str) -> bool:
    """Return True if a server that listens at a host can only be reached from this machine."""
    try:
        return ipaddress.ip_address(host.partition("%")[0]).is_loopback
    except ValueError:
        return host.lower() == "localhost"


def _plain(name: str) -> str:
    """Return an address in a unique form; a name unchanged."""
    try:
        address = ipaddress.ip_address(name.partition("%")[0])
    except ValueError:
        return name
    return str(getattr(address, "ipv4_mapped", None) or address)
