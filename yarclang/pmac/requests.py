"""Packets of the controller's Ethernet protocol: codes and sizes.

TCP port 1025. A packet is a header of 8 bytes (direction, code, wValue, wIndex, wLength; words with the high byte
first) and, if it goes down to the controller, wLength bytes of data. Sources: Turbo PMAC User Manual 416-419, UMAC Turbo
CPU/Communications Board manual 33-37, and the public clients pmacAsynIPPort and pgpmac.
"""

from __future__ import annotations

from enum import IntEnum

PORT = 1025
"""Where the controller listens, TCP."""

HEADER = ">BBHHH"
"""Direction, code, wValue, wIndex, wLength, as `struct` writes it."""

HEADER_SIZE = 8
"""Bytes of a header."""

DOWN = 0x40
"""Direction: data go to the controller."""

UP = 0xC0
"""Direction: wLength bytes are wanted from the controller; the packet has no data."""

MOST_DATA = 1492
"""Bytes of data in a packet, at most."""

MOST_REPLY = 1400
"""Bytes that the controller sends for one packet, at most; GETBUFFER fetches what is left."""

MOST_LINES = 1024
"""Bytes of data of a WRITEBUFFER, at most: lines, each with a NUL behind it."""

MOST_LINE = 254
"""Characters of a command line, at most, without its end (facts 3: 255 with it, known for older controllers)."""

CLIENTS = 2
"""Connections that the controller keeps at the same time."""


class Code(IntEnum):
    """What a packet asks for."""

    SENDLINE = 0xB0
    """Execute a line; one byte comes back at once, the reply waits for GETBUFFER or GETLINE."""
    GETLINE = 0xB1
    """The next line of a waiting reply."""
    FLUSH = 0xB3
    """Forget waiting replies; one byte comes back."""
    GETMEM = 0xB4
    """wLength bytes of the dual-ported memory from wValue on."""
    SETMEM = 0xB5
    """Data into the dual-ported memory from wValue on; one byte comes back."""
    SENDCTRLCHAR = 0xB6
    """Execute the control character in wValue; one byte comes back."""
    SETBIT = 0xBA
    """Set or clear one bit of the dual-ported memory; one byte comes back."""
    SETBITS = 0xBB
    """The same for several by a mask; one byte comes back."""
    PORT = 0xBE
    """One byte from or to a register of the host port."""
    GETRESPONSE = 0xBF
    """Execute a line; its reply comes back, up to 1400 bytes of it."""
    READREADY = 0xC2
    """Two bytes; the first isn't 0 if a reply is waiting."""
    CTRL_RESPONSE = 0xC4
    """Execute the control character in wValue; its reply comes back, without an ACK."""
    GETBUFFER = 0xC5
    """What is waiting of a reply, up to 1400 bytes."""
    WRITEBUFFER = 0xC6
    """Execute lines up to the first error; four bytes come back."""
    WRITEERROR = 0xC7
    """Not documented; taken for the four bytes of the last WRITEBUFFER again."""
    FWDOWNLOAD = 0xCB
    """Load firmware: yarclang never does."""
    IPADDRESS = 0xE0
    """The controller's address, four bytes."""


ACK = 0x06
"""Ends a reply without error (I3=2)."""

BEL = 0x07
"""Begins an error: BEL, ERRnnn, CR (I6=1); no ACK follows."""

CR = 0x0D
"""Ends an item of a reply."""

NUL = 0x00
"""Alone instead of a reply: the controller is busy, or has nothing to say; in WRITEBUFFER it ends a line."""

FLUSHED = 0x40
"""What real controllers answer to FLUSH (the manual says ^X)."""

ERROR_FLAG = 0x80
"""Byte 3 of a WRITEBUFFER's reply if a line was refused: byte 2 is the error, 1 and 0 (low) the line's number."""

ASKING_CONTROLS = "\x02\x03\x06\x07\x10\x16"
"""^B ^C ^F ^G ^P ^V: the control characters with a reply (UCPU 36)."""
