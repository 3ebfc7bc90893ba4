"""The Turbo PMAC section of a robot.toml."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

from yarclang.pmac.controller import NAME, TurboPmac
from yarclang.pmac.variables import signal_variable
from yarclang.robot.controller import Kind, SignalVariable
from yarclang.units import MS

if TYPE_CHECKING:
    from yarclang.robot.schema import ControllerTable
    from yarclang.toml.file import TomlFile
    from yarclang.toml.places import Path

AXES = "XYZABCUVW"
COUPLED = (frozenset("XYZ"), frozenset("UVW"))
"""Groups of axes that may be summed: the controller adds axes in a motor's definition only within one of
these groups (TSRM 269).
"""
FIRST_GUARD = 8100
"""P-variables from this number on belong to the guard, which the backend writes."""
LONGEST_TM = 4096.0
"""Longest segment time [ms]. The controller clips a longer time of a spline segment (TSRM 476)."""


def _table() -> type[ControllerTable]:
    from pydantic import Field

    from yarclang.robot.schema import ControllerTable

    class TurboPmacTable(ControllerTable):
        """`[controller]` of a Turbo PMAC: times in ms."""

        required = ("axes", "feedback")
        kind: Literal["turbo-pmac"] = "turbo-pmac"
        coordinate_system: Annotated[int, Field(ge=1, le=16)] = 1
        feedback: list[str] | None = None
        ixx08: Annotated[int, Field(ge=1, le=8_388_607)] = 96
        rotary_words: Annotated[int, Field(ge=48, le=1_000_000)] = 480
        i8: Annotated[int, Field(ge=0, le=255)] = 2
        i10: Annotated[int, Field(ge=1, le=8_388_607)] = 3_713_707

    return TurboPmacTable


def _controller(table: Any, motors: Sequence[int]) -> TurboPmac:
    return TurboPmac(
        kind=table.kind,
        coordinate_system=table.coordinate_system,
        axes=tuple(table.axes),
        motors=tuple(motors),
        feedback=tuple(table.feedback),
        largest_segment=table.largest_tm * MS,
        ixx08=table.ixx08,
        rotary_words=table.rotary_words,
        hold_time=table.hold_time * MS,
        rapid_share=table.rapid_share,
        i8=table.i8,
        i10=table.i10,
    )


def _check(file: TomlFile, table: Any, size: int) -> None:
    if table.axes is not None:
        _check_letters(file, "axes", table.axes, size)
    if table.feedback is not None:
        _check_letters(file, "feedback", table.feedback, size)
    least = 3.0 * (table.i8 + 1) * table.i10 / 8_388_608.0
    if not least < table.largest_tm <= LONGEST_TM:
        message = (
            f"largest_tm is {table.largest_tm:g} ms, but must be above {least:.2f} ms "
            f"(three real-time interrupts) and at most {LONGEST_TM:g} ms."
        )
        file.say("Y1328", ("controller", "largest_tm"), message, "Write largest_tm = 50 (ms).")


def _check_letters(file: TomlFile, key: str, names: Sequence[str], size: int) -> None:
    """Check the axes or the feedback variables of a robot description: each must be allowed, and none may
    occur twice.
    """
    from yarclang.robot.drive_checks import check_twice
    from yarclang.toml.file import right_length

    path: Path = ("controller", key)
    right_length(file, path, names, size, "name", "joint")
    for at, name in enumerate(names):
        if key == "axes" and (name not in AXES or len(name) != 1):
            message = f'axes[{at + 1}] is "{name[:20]}", which isn\'t an axis of the controller.'
            file.say("Y1321", (*path, at), message, f"Use the letters {' '.join(AXES)}, each once.")
        if key == "feedback" and not (
            re.fullmatch(r"P(0|[1-9][0-9]{0,3})", name) and int(name[1:]) < FIRST_GUARD
        ):
            message = (
                f'feedback[{at + 1}] is "{name[:20]}", which isn\'t a variable from P0 to P{FIRST_GUARD - 1}.'
            )
            file.say("Y1326", (*path, at), message, "Use P1, P2 and so on; higher ones belong to the guard.")
    code, what = ("Y1322", "Axis") if key == "axes" else ("Y1327", "Variable")
    check_twice(file, code, path, what, names)


def _not_coupled(axes: Sequence[str]) -> str:
    if not set(axes) <= set(AXES) or any(set(axes) <= group for group in COUPLED):
        return ""
    return "Give the coupled joints letters of X Y Z or of U V W in axes; A B C can't be coupled."


def _lines(size: int) -> tuple[str, ...]:
    axes = ", ".join(f'"{letter}"' for letter in AXES[:size])
    feedback = ", ".join(f'"P{k + 1}"' for k in range(size))
    return (
        "[controller]",
        f'kind = "{NAME}"',
        "coordinate_system = 1",
        f"axes = [{axes}]  # one a joint",
        f"feedback = [{feedback}]  # where PLC 0 writes the joint positions",
        "largest_tm = 50      # ms, the longest spline segment",
        "ixx08 = 96           # position scale factor: M162 is in 1/(ixx08 * 32) count; the factory setting",
        "rotary_words = 480   # least size of the rotary buffer",
        "hold_time = 250      # ms",
        "rapid_share = 0.1    # of the velocity limits, for the slow move to a program's start",
        "i8 = 2               # real-time interrupt every i8 + 1 servo cycles; the factory setting",
        "i10 = 3713707        # servo period, 1/8,388,608 ms; the factory setting",
    )


def _restored(values: Mapping[str, Any]) -> TurboPmac:
    return TurboPmac(**values)


def _signal(text: str) -> SignalVariable:
    return signal_variable(text, ())


KIND = Kind(
    name=NAME,
    title="a Turbo PMAC",
    table=_table,
    check=_check,
    not_coupled=_not_coupled,
    controller=_controller,
    restored=_restored,
    lines=_lines,
    signal=_signal,
)
