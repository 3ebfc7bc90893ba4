"""Packets of the controller's Ethernet protocol: codes and sizes.

The controller listens on TCP port 1025. A packet is a header of 8 bytes (direction, code, wValue, wIndex,
wLength; words with the high byte first), followed by wLength bytes of data if the packet goes down to the
controller. Sources: Turbo PMAC User Manual 416-419, UMAC Turbo CPU/Communications Board manual 33-37, and the
public clients pmacAsynIPPort and pgpmac.
"""

from __future__ import annotations

from enum import IntEnum

PORT = 1025
"""TCP port on which the controller listens."""

HEADER = ">BBHHH"
"""Direction, code, wValue, wIndex, wLength, as a `struct` format."""

HEADER_SIZE = 8
"""Size of a header [bytes]."""

DOWN = 0x40
"""Direction: data is sent to the controller."""

UP = 0xC0
"""Direction: wLength bytes are requested from the controller; the packet itself has no data."""

MOST_DATA = 1492
"""Maximum number of data bytes in a packet."""

MOST_REPLY = 1400
"""Maximum number of bytes that the controller sends in reply to one packet; GETBUFFER fetches the rest."""

MOST_LINES = 1024
"""Maximum number of data bytes of a WRITEBUFFER: lines, each followed by a NUL."""

MOST_LINE = 254
"""Maximum length of a command line in characters, without its terminator. Older controllers are known to
accept 255 characters including the terminator.
"""

CLIENTS = 2
"""Number of connections that the controller serves at the same time."""


class Code(IntEnum):
    """Purpose of a packet."""

    SENDLINE = 0xB0
    """Execute a line. One byte is returned at once; the reply waits for GETBUFFER or GETLINE."""
    GETLINE = 0xB1
    """Fetch the next line of a waiting reply."""
    FLUSH = 0xB3
    """Discard waiting replies. One byte is returned."""
    GETMEM = 0xB4
    """Read wLength bytes of the dual-ported memory, starting at wValue."""
    SETMEM = 0xB5
    """Write data into the dual-ported memory, starting at wValue. One byte is returned."""
    SENDCTRLCHAR = 0xB6
    """Execute the control character in wValue. One byte is returned."""
    SETBIT = 0xBA
    """Set or clear one bit of the dual-ported memory. One byte is returned."""
    SETBITS = 0xBB
    """Set or clear several bits of the dual-ported memory by a mask. One byte is returned."""
    PORT = 0xBE
    """Read or write one byte of a register of the host port."""
    GETRESPONSE = 0xBF
    """Execute a line and return its reply, up to 1400 bytes."""
    READREADY = 0xC2
    """Return two bytes; the first is not 0 if a reply is waiting."""
    CTRL_RESPONSE = 0xC4
    """Execute the control character in wValue and return its reply, without an ACK."""
    GETBUFFER = 0xC5
    """Fetch the waiting part of a reply, up to 1400 bytes."""
    WRITEBUFFER = 0xC6
    """Execute lines up to the first error. Four bytes are returned."""
    WRITEERROR = 0xC7
    """Not documented; assumed to return the four bytes of the last WRITEBUFFER again."""
    FWDOWNLOAD = 0xCB
    """Load firmware. Never used by yarclang."""
    IPADDRESS = 0xE0
    """Return the controller's address, four bytes."""


ACK = 0x06
"""End of a reply without error (I3=2)."""

BEL = 0x07
"""Beginning of an error: BEL, ERRnnn, CR (I6=1). No ACK follows."""

CR = 0x0D
"""End of an item of a reply."""

NUL = 0x00
"""A NUL byte alone instead of a reply: the controller is busy or has nothing to report. In WRITEBUFFER: end
of a line.
"""

FLUSHED = 0x40
"""Reply of real controllers to FLUSH (the manual states ^X)."""

ERROR_FLAG = 0x80
"""Byte 3 of the reply to WRITEBUFFER if a line was refused. Byte 2 is the error; bytes 1 and 0 (low)
are the number of the line.
"""

ASKING_CONTROLS = "\x02\x03\x06\x07\x10\x16"
"""^B ^C ^F ^G ^P ^V: the control characters that are answered with a reply (UCPU 36)."""
