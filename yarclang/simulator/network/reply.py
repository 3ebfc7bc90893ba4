"""Replies of the controller to a line, and their framing by I3 and I6 (TSRM 37-38, PSRM 25)."""

from __future__ import annotations

from dataclasses import dataclass

ACK = b"\x06"
BEL = b"\x07"
CR = b"\r"
LF = b"\n"

_ACKNOWLEDGED = {0: b"", 1: LF}
"""End of a reply, by the value of I3. For other values it is an ACK."""


@dataclass(frozen=True, slots=True)
class Reply:
    """Reply to a line.

    Attributes:
        items: the values that the line asked for, in order.
        error: number of the error that ended the line; None if there was no error.
    """

    items: tuple[str, ...] = ()
    error: int | None = None

    @property
    def text(self) -> str:
        """All values, one per line."""
        return "\n".join(self.items)


class Refusal(Exception):  # noqa: N818 - behaviour of the controller, not an error of the simulator
    """The controller refuses a command with ERR`number`."""

    def __init__(self, number: int) -> None:
        super().__init__(f"ERR{number:03d}")
        self.number = number


def framed(reply: Reply, i3: int, i6: int) -> bytes:
    """Return a reply as bytes, framed as the controller's settings require.

    I3 selects the framing of data and acknowledgment: 0 DATA CR; 1 LF DATA CR ... LF; 2 DATA CR ... ACK;
    3 LF DATA CR ... ACK. I6 selects the framing of an error: 0 and 2 BEL alone, 1 BEL ERRnnn CR,
    3 BEL CR ERRnnn CR. No acknowledgment follows an error.

    Args:
        reply: the reply.
        i3: value of I3.
        i6: value of I6.
    """
    feed = LF if i3 in (1, 3) else b""
    between = "\r\n" if feed else "\r"
    data = b""
    if reply.items:
        text = "\0".join(reply.items).replace("\n", "\r").replace("\0", between)
        data = feed + text.encode("ascii", "replace") + CR
    if reply.error is None:
        return data + _ACKNOWLEDGED.get(i3, ACK)
    number = b"ERR%03d" % reply.error + CR
    match i6:
        case 1:
            return data + BEL + feed + number
        case 3:
            return data + BEL + CR + feed + number
        case _:
            return data + BEL
