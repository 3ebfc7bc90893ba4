"""Controller program to text."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from yarclang.pmac.program import Assignment, Moves, PmacProgram, SegmentTime
from yarclang.pmac.variables import ASTRAY, commanded_position

_ROWS_AT_ONCE = 1000
_TRAILING_ZEROS = re.compile(r"\.?0+(?=[A-Z\n])")


def emit(program: PmacProgram) -> str:
    """The text of a program.

    It loads a buffer and moves nothing: whoever runs it sends R. The lines of the header
    come first, then the map of commands, then what the controller reads.
    """
    opening = list(_opening(program))
    first = 1 + len(program.header) + len(program.commands) + len(opening)
    pieces: list[str] = []
    places: dict[int, tuple[int, int]] = {}
    line = first
    for item in program.body:
        if isinstance(item, Moves):
            pieces.append(_moves(program, item.values))
            end = line + len(item.values)
            places[item.step] = (places.get(item.step, (line, 0))[0], end - 1)
            line = end
        else:
            pieces.append(_word(item) + "\n")
            line += 1
    head = [f"; {text}" if text else ";" for text in program.header]
    for command in program.commands:
        start, stop = places.get(command.step, ("-", "-"))
        head.append(
            f"; command {command.step} {command.index} {command.name} {command.source_line} {start} {stop}"
        )
    return "\n".join((*head, *opening, "")) + "".join(pieces) + "CLOSE\n"


def segment_time(milliseconds: float) -> str:
    """A segment time in ms, exactly: a step of 1/4096 ms has at most 12 decimals."""
    return f"{milliseconds:.12f}".rstrip("0").rstrip(".")


def _word(item: SegmentTime | Assignment) -> str:
    if isinstance(item, SegmentTime):
        return f"TM{segment_time(item.milliseconds)}"
    return f"{item.variable}={item.value}"


def _moves(program: PmacProgram, values: NDArray[np.float64]) -> str:
    """Move lines of `values` (k, axes), many rows in one formatting."""
    row = "".join(f"{axis}%.{program.decimals}f" for axis in program.axes) + "\n"
    pieces = []
    for start in range(0, len(values), _ROWS_AT_ONCE):
        block = values[start : start + _ROWS_AT_ONCE]
        pieces.append((row * len(block)) % tuple(block.ravel().tolist()))
    return _TRAILING_ZEROS.sub("", "".join(pieces))


def _opening(program: PmacProgram) -> Iterator[str]:
    """Everything up to the first move of the motion."""
    yield "CLOSE ALL"
    yield "END GATHER"
    yield "DELETE GATHER"
    yield f"&{program.coordinate_system}"
    if program.target == "rotary":
        yield from _open_rotary(program)
    else:
        yield from _open_prog(program)
    yield "SPLINE1"


def _open_rotary(program: PmacProgram) -> Iterator[str]:
    """The paper's Listing 3, and a slow RAPID move to the start."""
    yield "".join(f"#{motor}J/" for motor in program.motors)
    yield "DELETE ROT"
    yield f"I16={program.low_lines}"
    yield f"I17={program.full_lines}"
    yield f"DEFINE ROT {program.rotary_words}"
    yield "B0"
    yield "OPEN ROT"
    yield "CLEAR"
    yield "RAPID"
    yield "ABS"
    yield _moves(program, program.start[None]).rstrip("\n")
    yield "DWELL0"


def _open_prog(program: PmacProgram) -> Iterator[str]:
    """A program buffer that goes no further before every motor stands at the start: after each STOP all
    motors are looked at again.
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
