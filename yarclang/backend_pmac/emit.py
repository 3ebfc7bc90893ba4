"""Printing a controller program as text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from yarclang.backend_pmac.barriers import barrier_lines, printable
from yarclang.backend_pmac.move_lines import move_lines
from yarclang.decisions import KeptTo, Permitted, Register, Searched, Shifted, Watch
from yarclang.emitted.quoting import allow_line, keep_line
from yarclang.frozen import frozen
from yarclang.memory import NO_MEMORY, Forgetful, Memory
from yarclang.pmac.program import (
    Assignment,
    Barrier,
    Command,
    Disarm,
    Moves,
    PmacProgram,
    Rest,
    SegmentTime,
    Stand,
)
from yarclang.pmac.variables import ARMED, ASTRAY, DISARMS, OUTPUTS_PLC, WATCHED, commanded_position
from yarclang.progress import each


@frozen
class Emitted:
    """The text of a program without its header.

    `opening` is everything up to the first move of the motion, `body` the rest. `places` maps each step to
    its first and last move line, and `barriers` has the line of each barrier; these lines are counted from
    the first line of the body. The other attributes are written to the map of the program in the header.
    """

    commands: tuple[Command, ...]
    opening: tuple[str, ...]
    body: str
    places: Mapping[int, tuple[int, int]]
    barriers: tuple[tuple[int, Barrier], ...]
    registers: tuple[Register, ...] = ()
    watches: tuple[Watch, ...] = ()
    searches: tuple[Searched, ...] = ()
    offsets: tuple[Shifted, ...] = ()
    allows: tuple[Permitted, ...] = ()
    keeps: tuple[KeptTo, ...] = ()

    def text(self, header: tuple[str, ...]) -> str:
        """Return the whole text.

        The header lines come first. The map follows, as comments: commands, barriers, registers, watches,
        searches, offsets, bodies that may touch, and rules of KEEP. The lines that the controller reads are
        last.
        """
        maps = len(self.commands) + len(self.barriers) + len(self.registers) + len(self.watches)
        # A motion of length zero has no lines, so no input can end it.
        searches = [one for one in self.searches if one.step in self.places]
        allows = [one for one in self.allows if one.step in self.places]
        keeps = [one for one in self.keeps if one.step in self.places]
        maps += len(searches) + len(self.offsets) + len(allows) + len(keeps)
        before = len(header) + maps + len(self.opening)
        head = [f"; {line}" if line else ";" for line in header]
        for command in self.commands:
            place = self.places.get(command.step)
            lines = f"{before + place[0]} {before + place[1]}" if place else "- -"
            flows = "" if command.overlap is None else f" blend {command.overlap}"
            jerk = " any-jerk" if command.any_jerk and place else ""
            head.append(
                f"; command {command.step} {command.index} {command.name} {command.source_line} "
                f"{lines}{flows}{jerk}"
            )
        for line, barrier in self.barriers:
            head.append(f"; barrier {before + line} {_told(barrier)}")
        head += [
            f"; register {one.name} {one.low} {one.high} "
            f"{one.first}{' kept' * one.kept}{' outside' * one.outside}"
            for one in self.registers
        ]
        head += [
            f"; watch {one.variable}={_number(one.value)} "
            f"{one.name}{f' then {one.then} {one.way}' if one.then else ''}"
            for one in self.watches
        ]
        head += [
            f"; search {one.step} {one.variable}={_number(one.value)} {one.name} {one.flag} "
            f"{one.depth or '-'}"
            for one in searches
        ]
        head += [
            f"; offset {one.step} {one.flag} {' '.join(name or '-' for name in one.registers)} "
            f"{printable(one.frame)}"
            for one in self.offsets
        ]
        head += map(allow_line, allows)
        head += map(keep_line, keeps)
        return "\n".join((*head, *self.opening, "")) + self.body


def _told(barrier: Barrier) -> str:
    """Return a barrier's entry in the map of the header: kind, step, condition, timeout, and name or text."""
    waited = f"{barrier.variable}={_number(barrier.value)}" if barrier.variable else "-"
    condition = barrier.condition or waited
    timeout = "-" if barrier.timeout is None else f"{barrier.timeout:.9g}"
    return f"{barrier.kind} {barrier.step} {condition} {timeout} {printable(barrier.name) or '-'}"


def emit(program: PmacProgram, memory: Memory = NO_MEMORY) -> Emitted:
    """Print a controller program as text.

    The text loads a buffer and moves nothing: the robot starts to move when the command R is sent.

    Args:
        program: the program.
        memory: cache for the text of move lines.
    """
    moves = _moves(program, memory)
    pieces: list[str] = []
    places: dict[int, tuple[int, int]] = {}
    barriers: list[tuple[int, Barrier]] = []
    line = 1
    for item in program.body:
        if isinstance(item, Moves):
            pieces.append(next(moves))
            end = line + len(item.values)
            places[item.step] = (places.get(item.step, (line, 0))[0], end - 1)
            line = end
            continue
        if isinstance(item, Barrier):
            barriers.append((line, item))
        words = _words(program, item)
        pieces.append("".join(f"{word}\n" for word in words))
        line += len(words)
    body = "".join(pieces) + "CLOSE\n"
    return Emitted(
        program.commands,
        tuple(_opening(program)),
        body,
        places,
        tuple(barriers),
        program.registers,
        program.watches,
        program.searches,
        program.offsets,
        program.allows,
        program.keeps,
    )


def _words(
    program: PmacProgram, item: SegmentTime | Assignment | Disarm | Rest | Stand | Barrier
) -> tuple[str, ...]:
    match item:
        case SegmentTime(milliseconds=milliseconds):
            return (f"TM{segment_time(milliseconds)}",)
        case Assignment(variable=variable, value=value, in_step=in_step):
            return (f"{variable}{'==' if in_step else '='}{_number(value)}",)
        case Disarm():
            return (DISARMS,)
        case Rest(milliseconds=milliseconds):
            return (f"DWELL{_number(milliseconds)}",)
        case Stand(point=point):
            return ("RAPID", "ABS", _point(program, point), "DWELL0", "SPLINE1")
        case Barrier():
            return barrier_lines(item, program.target, program.coordinate_system)


def segment_time(milliseconds: float) -> str:
    """Print a segment time in ms exactly: a multiple of 1/4096 ms has at most 12 decimals."""
    return f"{milliseconds:.12f}".rstrip("0").rstrip(".")


def _number(value: float) -> str:
    """Print a number without an exponent, as short as possible."""
    return f"{value:.9f}".rstrip("0").rstrip(".")


def _moves(program: PmacProgram, memory: Memory) -> Iterator[str]:
    """Yield the lines of all moves, one item of the body after the other."""
    values = [item.values for item in program.body if isinstance(item, Moves)]
    if isinstance(memory, Forgetful):
        yield from each(move_lines(program.axes, program.decimals, values))
        return
    keys = [("moves", program.axes, program.decimals, one.tobytes()) for one in values]
    known: list[str | None] = [memory.get(key) for key in keys]
    missing = [one for one, text in zip(values, known, strict=True) if text is None]
    made = each(move_lines(program.axes, program.decimals, missing))
    for key, text in zip(keys, known, strict=True):
        if text is None:
            text = next(made)  # noqa: PLW2901 - what is known then
            memory.keep(key, text)
        yield text


def _point(program: PmacProgram, point: NDArray[np.float64]) -> str:
    """Return the move line to one point (axes,) [axis units]."""
    return next(move_lines(program.axes, program.decimals, [point[None]])).rstrip("\n")


def _opening(program: PmacProgram) -> Iterator[str]:
    """Yield all lines before the first move of the motion."""
    yield "CLOSE ALL"
    yield "END GATHER"
    yield "DELETE GATHER"
    yield from _safe_outputs(program)
    yield f"&{program.coordinate_system}"
    if program.target == "rotary":
        yield from _open_rotary(program)
    else:
        yield from _open_prog(program)
    yield "SPLINE1"


def _safe_outputs(program: PmacProgram) -> Iterator[str]:
    """Yield the lines of the PLC that sets the outputs to their safe values after the guard or the watchdog
    has held the motion.
    """
    if not program.safe_outputs:
        return
    yield f"OPEN PLC {OUTPUTS_PLC} CLEAR"
    yield f"IF({ARMED}=2 OR {WATCHED}=2)"
    for variable, value in program.safe_outputs:
        yield f"{variable}={_number(value)}"
    yield "ENDIF"
    yield "CLOSE"
    yield f"ENABLE PLC {OUTPUTS_PLC}"


def _open_rotary(program: PmacProgram) -> Iterator[str]:
    """Yield the lines that open a rotary buffer (Listing 3 of the paper), with a slow RAPID move to the start
    if the program has one.
    """
    yield "".join(f"#{motor}J/" for motor in program.motors)
    yield "DELETE ROT"
    yield f"I16={program.low_lines}"
    yield f"I17={program.full_lines}"
    yield f"DEFINE ROT {program.rotary_words}"
    yield "B0"
    yield "OPEN ROT"
    yield "CLEAR"
    if not program.rapid:
        yield "ABS"
        return
    yield "RAPID"
    yield "ABS"
    yield _point(program, program.start)
    yield "DWELL0"


def _open_prog(program: PmacProgram) -> Iterator[str]:
    """Yield the lines that open a program buffer. The program continues only when every motor is at the
    start.

    After each STOP, all motors are checked again.
    """
    yield "OPEN PROG 1 CLEAR"
    yield f"{ASTRAY}=1"
    yield f"WHILE({ASTRAY}=1)"
    yield f"{ASTRAY}=0"
    for motor, counts, slack in zip(program.motors, program.start_counts, program.start_slack, strict=True):
        position, _ = commanded_position(motor)
        yield f"IF(ABS({position}{-round(counts):+d})>{int(slack)})"
        yield f"{ASTRAY}=1"
        yield f'SEND"YARC: MOTOR {motor} IS NOT AT THE START"'
        yield "ENDIF"
    yield f"IF({ASTRAY}=1)"
    yield "STOP"
    yield "ENDIF"
    yield "ENDWHILE"
    yield "ABS"
