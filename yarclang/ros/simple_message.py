"""The wire format of simple_message: encoding of messages, and decoding of a stream of bytes. No I/O.

A frame consists of a length, a header of three words, and a body. All words have 4 bytes, and there are
always 10 slots for joints. The length doesn't include its own word.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum, IntEnum
from typing import ClassVar

SLOTS = 10
"""Joint slots of a message. Slots beyond the robot's joints are 0."""

MOST = 1020
"""Largest length of a frame [bytes]: ROS-Industrial's nodes receive at most 1024 bytes at a time, including
the word that contains the length.
"""

_HEADER = 12
_NONE = (0.0,) * SLOTS


class ByteOrder(Enum):
    """Order of the bytes in a word. The values are those of the module `struct`."""

    LITTLE = "<"
    """Byte order of ROS-Industrial's standard nodes on usual computers."""
    BIG = ">"
    """Byte order of ROS-Industrial's nodes whose names end with _bswap."""

    @property
    def other(self) -> ByteOrder:
        """The opposite byte order."""
        return ByteOrder.BIG if self is ByteOrder.LITTLE else ByteOrder.LITTLE


class Comm(IntEnum):
    """Communication type of a message."""

    TOPIC = 1
    REQUEST = 2
    REPLY = 3


class Code(IntEnum):
    """Code of a reply. Other messages have NONE."""

    NONE = 0
    SUCCESS = 1
    FAILURE = 2


class Sequence(IntEnum):
    """Sequence numbers of trajectory points with a special meaning."""

    START_DOWNLOAD = -1
    START_STREAMING = -2
    END = -3
    """Last point of a download."""
    STOP = -4


class FrameError(ValueError):
    """Raised for bytes that aren't simple_message; the text gives the reason and the remedy."""


@dataclass(frozen=True, slots=True)
class Ping:
    """Message without content, to test the connection."""

    kind: ClassVar[int] = 1


@dataclass(frozen=True, slots=True)
class JointPosition:
    """Content of a message: positions of the joints.

    Attributes:
        joints: (10,) positions [rad or m].
        sequence: a number that ROS-Industrial's nodes don't use.
    """

    joints: tuple[float, ...]
    sequence: int = 0
    kind: ClassVar[int] = 10


@dataclass(frozen=True, slots=True)
class TrajectoryPoint:
    """Content of a message: one waypoint of a trajectory.

    Attributes:
        sequence: index in the trajectory from 0, or one of `Sequence`.
        joints: (10,) positions [rad or m].
        velocity: share of the velocity limit for the fastest joint; 0.1 if the trajectory has no velocities.
        duration: time since the previous waypoint [s]; without meaning for the first waypoint.
    """

    sequence: int
    joints: tuple[float, ...] = _NONE
    velocity: float = 0.0
    duration: float = 0.0
    kind: ClassVar[int] = 11


@dataclass(frozen=True, slots=True)
class RobotStatus:
    """Content of a message: status of the robot, with 1 for yes, 0 for no, -1 for unknown.

    Attributes:
        drives_powered: all motors are in closed loop.
        e_stopped: an emergency stop is active.
        error_code: number of a finding; 0 for none.
        in_error: a goal was refused, or an error occurred.
        in_motion: the robot moves.
        mode: 1 manual, 2 automatic.
        motion_possible: a trajectory would be run now.
    """

    drives_powered: int
    e_stopped: int
    error_code: int
    in_error: int
    in_motion: int
    mode: int
    motion_possible: int
    kind: ClassVar[int] = 13


@dataclass(frozen=True, slots=True)
class FullPoint:
    """Content of a message: a waypoint with the derivatives of all joints. ROS-Industrial's nodes don't send
    it.

    Attributes:
        robot: number of a group of joints.
        sequence: index in the trajectory from 0, or one of `Sequence`.
        valid: sum of the flags of the valid fields: 1 time, 2 positions, 4 velocities, 8 accelerations.
        time: time since the start of the trajectory [s].
        positions: (10,) positions [rad or m].
        velocities: (10,) velocities [rad/s or m/s].
        accelerations: (10,) accelerations [rad/s² or m/s²].
    """

    robot: int
    sequence: int
    valid: int
    time: float
    positions: tuple[float, ...]
    velocities: tuple[float, ...]
    accelerations: tuple[float, ...]
    kind: ClassVar[int] = 14


@dataclass(frozen=True, slots=True)
class JointFeedback:
    """Content of a message: positions of the joints with their derivatives. ROS-Industrial's nodes don't
    understand it. The attributes are those of `FullPoint`.
    """

    robot: int
    valid: int
    time: float
    positions: tuple[float, ...]
    velocities: tuple[float, ...]
    accelerations: tuple[float, ...]
    kind: ClassVar[int] = 15


@dataclass(frozen=True, slots=True)
class Other:
    """A message of an unknown kind: its number and its bytes."""

    kind: int
    content: bytes


Body = Ping | JointPosition | TrajectoryPoint | RobotStatus | FullPoint | JointFeedback | Other


@dataclass(frozen=True, slots=True)
class Message:
    """A message of the protocol.

    Attributes:
        comm: communication type: topic, request or reply.
        body: content of the message.
        code: code of a reply.
    """

    comm: Comm
    body: Body
    code: Code = Code.NONE


def reply_to(message: Message, *, success: bool) -> Message:
    """Return the reply to a request. It repeats the body of the request, as the reference controllers do."""
    return Message(Comm.REPLY, message.body, Code.SUCCESS if success else Code.FAILURE)


_FORMS = {
    Ping.kind: "",
    JointPosition.kind: "i10f",
    TrajectoryPoint.kind: "i10f2f",
    RobotStatus.kind: "7i",
    FullPoint.kind: "3if30f",
    JointFeedback.kind: "2if30f",
}
"""Formats of the known bodies for `struct`."""

_BODIES = {
    order: {kind: struct.Struct(order.value + form) for kind, form in _FORMS.items()} for order in ByteOrder
}
_WORD = {order: struct.Struct(order.value + "i") for order in ByteOrder}
_HEAD = {order: struct.Struct(order.value + "3i") for order in ByteOrder}
_FRAME = {order: struct.Struct(order.value + "4i") for order in ByteOrder}
_LONG_REALS = {_HEADER + 4 * 4 + 8 * 12: TrajectoryPoint.kind, _HEADER + 4 + 8 * 10: JointPosition.kind} | {
    _HEADER + 4 + 8 * 12: TrajectoryPoint.kind,
    _HEADER + 3 * 4 + 8 * 31: FullPoint.kind,
}
"""Kinds of messages by the length that their frame has if the client sends 8-byte real numbers. Such frames
are refused with a hint.
"""


def encode(message: Message, order: ByteOrder = ByteOrder.LITTLE) -> bytes:
    """Return the frame of a message.

    Args:
        message: the message. Its real numbers are rounded to single precision.
        order: order of the bytes.

    Raises:
        OverflowError: a real number is too large for single precision.
        struct.error: an integer has more than 32 bits, or joints don't have 10 slots.
    """
    body = message.body
    content = body.content if isinstance(body, Other) else _BODIES[order][body.kind].pack(*_numbers(body))
    head = _FRAME[order].pack(_HEADER + len(content), body.kind, message.comm, message.code)
    return head + content


class Decoder:
    """Decoder of messages from a stream of bytes, which may be split anywhere. It stores at most the last
    input and an incomplete frame.

    Args:
        order: order of the bytes.
    """

    def __init__(self, order: ByteOrder = ByteOrder.LITTLE) -> None:
        self._order = order
        self._waiting = bytearray()

    def feed(self, data: bytes) -> Iterator[Message]:
        """Add received bytes, and yield the messages that are complete.

        Raises:
            FrameError: the bytes aren't simple_message. Close the connection, because the beginning of the
                next frame is unknown.
        """
        self._waiting += data
        while (message := self._next()) is not None:
            yield message

    @property
    def waiting(self) -> int:
        """Number of bytes that wait for the rest of their frame."""
        return len(self._waiting)

    def _next(self) -> Message | None:
        waiting, order = self._waiting, self._order
        if len(waiting) < _WORD[order].size:
            return None
        (length,) = _WORD[order].unpack_from(waiting)
        if not _HEADER <= length <= MOST:
            raise FrameError(self._implausible(length))
        whole = _WORD[order].size + length
        if len(waiting) < whole:
            return None
        frame = bytes(waiting[_WORD[order].size : whole])
        message = _decoded(frame, order)
        del waiting[:whole]
        return message

    def _implausible(self, length: int) -> str:
        (other,) = _WORD[self._order.other].unpack_from(self._waiting)
        if _HEADER <= other <= MOST:
            swap = "with" if self._order is ByteOrder.LITTLE else "without"
            return (
                f"the bytes of each word arrive in the other order: the length reads {length}, the other "
                f"way round {other}; "
                f"start `yarc ros` {swap} --swap-bytes"
            )
        return (
            f"a length of {length} bytes, {_HEADER} to {MOST} are possible; look which program connects "
            f"to this port"
        )


def _decoded(frame: bytes, order: ByteOrder) -> Message:
    kind, comm, code = _HEAD[order].unpack_from(frame)
    if comm not in iter(Comm):
        raise FrameError(
            f"a message of kind {kind} is neither topic (1), request (2) nor reply (3), but {comm}"
        )
    if (code in (Code.SUCCESS, Code.FAILURE)) != (comm == Comm.REPLY) or code not in iter(Code):
        raise FrameError(f"a message of kind {kind}, {Comm(comm).name.lower()}, has the reply code {code}")
    content = frame[_HEADER:]
    form = _BODIES[order].get(kind)
    if form is None:
        return Message(Comm(comm), Other(kind, content), Code(code))
    if len(content) != form.size:
        raise FrameError(_wrong_size(kind, len(content), form.size))
    return Message(Comm(comm), _body(kind, form.unpack(content)), Code(code))


def _wrong_size(kind: int, found: int, wanted: int) -> str:
    text = f"a message of kind {kind} has {found} bytes, {wanted} are wanted"
    if _LONG_REALS.get(_HEADER + found) == kind:
        return f"{text}: its real numbers have 8 bytes; build the client's nodes without FLOAT64"
    return text


def _numbers(body: Body) -> tuple[float, ...]:
    match body:
        case JointPosition():
            return (body.sequence, *body.joints)
        case TrajectoryPoint():
            return (body.sequence, *body.joints, body.velocity, body.duration)
        case RobotStatus():
            return (
                body.drives_powered, body.e_stopped, body.error_code, body.in_error,
                body.in_motion, body.mode, body.motion_possible,
            )  # fmt: skip
        case FullPoint():
            derivatives = (*body.positions, *body.velocities, *body.accelerations)
            return (body.robot, body.sequence, body.valid, body.time, *derivatives)
        case JointFeedback():
            return (body.robot, body.valid, body.time, *body.positions, *body.velocities, *body.accelerations)
    return ()


def _body(kind: int, found: tuple[float, ...]) -> Body:
    """Convert the words of a message's body to the body of this kind. The integers come before the real
    numbers.
    """
    if kind == JointPosition.kind:
        return JointPosition(found[1:], int(found[0]))
    if kind == TrajectoryPoint.kind:
        return TrajectoryPoint(int(found[0]), found[1:11], found[11], found[12])
    if kind == RobotStatus.kind:
        return RobotStatus(*map(int, found))
    if kind == FullPoint.kind:
        robot, sequence, valid = map(int, found[:3])
        return FullPoint(robot, sequence, valid, found[3], found[4:14], found[14:24], found[24:])
    if kind == JointFeedback.kind:
        return JointFeedback(int(found[0]), int(found[1]), found[2], found[3:13], found[13:23], found[23:])
    return Ping()
