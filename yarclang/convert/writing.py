"""Write a readable YARC program from the content of another file: a comment about its origin, names, and
targets in columns.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from yarclang.convert.columns import (
    DEFAULT_TIME,
    SAME_PLACE,
    STEP,
    comment_of,
    index_text,
    plain,
    rows_of,
    seconds,
)
from yarclang.convert.course import Content, Converted, Course, Form, Wishes
from yarclang.convert.thinning import thinned, way_shares
from yarclang.convert.timed import at_rest, timed_motion
from yarclang.diagnostics import Collector
from yarclang.hir import Array
from yarclang.robot.library import list_robots
from yarclang.robot.model import Robot
from yarclang.semantics.motions.trajectory_file import SUFFIX


def program_text(
    name: str, content: Content, robot: Robot, wishes: Wishes, findings: Collector
) -> Converted | None:
    """Return the program and the files that it refers to; None, with an error, if it can't be written.

    Args:
        name: name of the converted file, for the first comment.
        content: the motions and joint positions in the file.
        robot: the robot.
        wishes: the options.
        findings: collects findings, including a warning if waypoints are too dense.
    """
    lines = [f"{plain(name)}: {content.kind}."]
    body: list[str] = []
    files: list[tuple[str, str]] = []
    index = STEP
    here: Array | None = None
    for number, whole in enumerate(content.courses):
        form = _form(whole, wishes)
        if form == "timed" and (whole.target != "JOINTS" or whole.times is None):
            what = "has no times" if whole.times is None else "has poses"
            message = f"the file {what}, but --as timed needs joint values with times"
            findings.add("Y1514", message, None, "omit --as, or give a file with times")
            return None
        course = thinned(whole, wishes.every, wishes.tolerance, robot, form)
        if form != "timed":
            course = _without_repeats(course)
        lines += whole.remarks
        if course.size < whole.size:
            lines.append(f"{course.size:,} of {whole.size:,} points are kept{_why_fewer(wishes)}.")
        if form == "timed" and course.size > 1:
            where = "" if len(content.courses) == 1 else f"trajectory {number + 1}: "
            resting = at_rest(course, where, robot, findings)
            if resting is None:
                return None
            timed, about = resting
            _check_density(course, robot, wishes, findings)
            ending = "" if len(content.courses) == 1 else f"{number + 1}"
            file = None if wishes.beside is None else f"{wishes.beside}_path{ending}{SUFFIX}"
            written = timed_motion(timed, index, here, robot, file)
            lines += (*about, *written.remarks)
            files += written.files
            rows, index, here = written.rows, written.index, course.values[-1]
        elif form == "spline" and course.size > 1:
            lines += _about_times(course, robot, wishes)
            _check_density(course, robot, wishes, findings)
            rows, index, here = _spline(course, index, here, is_first=number == 0, wishes=wishes)
        else:
            rows, index, here = _moves(course, index, wishes)
        body += ["", *rows]
    if content.positions:
        body += ["", *_positions(content.positions), "", f"{index_text(index)} STOP"]
        lines.append("Without ROBOT and STOP it is a module, whose positions other programs USE.")
    known = any(one.folder == robot.folder for one in list_robots())
    if not known:
        lines.append(f"Made for {robot.name}, which --robot or yarc.toml has to name.")
    frame = "{TCP}" if "TCP" in robot.flange_from_frame else "{FLANGE}"
    head = [f"! {line}" for line in lines]
    head += [f"ROBOT {robot.name}"] * known
    head.append(f"DEFAULT {frame} [{wishes.time or DEFAULT_TIME}] (mm,deg,s) {{B}}")
    return Converted("".join(f"{line}\n" for line in (*head, *body)), tuple(files))


def _form(course: Course, wishes: Wishes) -> Form:
    """Return the form in which a motion is written: moves (a stop at each target), spline (through all
    targets without a stop) or timed (through all targets at their times).

    This is the form that the user has chosen. Without a choice, it is moves for a motion without times,
    timed for joint values if the user has given no duration, and otherwise spline.
    """
    if wishes.form is not None:
        return wishes.form
    if course.times is None:
        return "moves"
    return "timed" if course.target == "JOINTS" and wishes.time is None else "spline"


def _moves(course: Course, index: int, wishes: Wishes) -> tuple[list[str], int, Array]:
    """Return three values: the program lines of moves that stop at each target; the next index; and the last
    target.

    The lines begin with declarations of the named targets.
    """
    rows: list[str] = []
    cells = rows_of(course.values, course.target)
    words = {
        "JOINTS": ("MOVEJ", "MOVEJ"),
        "RPY": ("MOVEJ_RPY", "MOVEL"),
        "QUAT": ("MOVEJ_QUAT", "MOVEL_QUAT"),
    }
    first, later = words[course.target]
    width = len(first) if course.size == 1 else max(len(first), len(later))
    if course.names:
        declared: dict[str, str] = {}
        for name, cell in zip(course.names, cells, strict=True):
            if name:
                declared.setdefault(name, cell)
        rows += [*_declarations(declared, course), ""] if declared else []
    only = course.size == 1 and course.times is not None and course.times[0] > 0 and wishes.time is None
    time = f" [{seconds(float(course.times[0]))}]" if only and course.times is not None else ""
    at_frame = "0 0 0 0 0 0 0 1" if course.target == "QUAT" else "0 0 0 0 0 0"
    at_frame = at_frame.removeprefix("0 ") if course.target == "QUAT" else at_frame
    for number, cell in enumerate(cells):
        name = course.names[number] if course.names else ""
        goal = cell
        if name:
            goal = name if course.target == "JOINTS" else f"{at_frame} {{{name}}}"
        word = first if number == 0 else later
        rows.append(f"{index_text(index)} {word:{width}} {goal}{time}{comment_of(course, number)}")
        index += STEP
    return rows, index, course.values[-1]


def _declarations(declared: dict[str, str], course: Course) -> list[str]:
    """Return the program lines that declare named targets, with JOINTS or FRAME."""
    widest = max(map(len, declared))
    if course.target == "JOINTS":
        return [f"JOINTS {name:{widest}} {cell}" for name, cell in declared.items()]
    word = "FRAME_QUAT" if course.target == "QUAT" else "FRAME"
    return [f"{word} {f'{{{name}}}':{widest + 2}} {cell}" for name, cell in declared.items()]


def _spline(
    course: Course, index: int, here: Array | None, is_first: bool, wishes: Wishes
) -> tuple[list[str], int, Array]:
    """Return three values: the program lines of a motion through all targets without a stop; the next index;
    and the last target.

    The motion time is the time between the first and the last target. If the motion is the program's first
    one and has joint values, its first target becomes the start of the program (START). Otherwise a move to
    its first target is written before the motion, unless the robot is already there.

    Args:
        course: the motion.
        index: number of the first command's index.
        here: (k,) last target of the previous motion; None for the first motion.
        is_first: True for the first motion.
        wishes: the options.
    """
    cells = rows_of(course.values, course.target)
    suffix = "" if course.target == "JOINTS" else f"_{course.target}"
    rows: list[str] = []
    if course.target == "JOINTS" and is_first:
        rows += [f"START {cells[0].strip()}{comment_of(course, 0, True)}", ""]
    elif (
        here is None
        or len(here) != course.values.shape[1]
        or np.abs(here - course.values[0]).max() > SAME_PLACE
    ):
        rows.append(
            f"{index_text(index)} MOVEJ{suffix} {cells[0].strip()} "
            f"[{DEFAULT_TIME}]{comment_of(course, 0, True)}"
        )
        index += STEP
    time = ""
    if course.times is not None and wishes.time is None:
        time = f" [{seconds(float(course.times[-1] - course.times[0]))}]"
    word = f"MOVEJ{suffix}" if course.size == 2 else f"MOVEJ_SPLINE{suffix}"
    head = f"{index_text(index)} {word} "
    for number in range(1, course.size):
        end = f"{time}" if number == course.size - 1 else ";"
        rows.append(f"{head}{cells[number]}{end}{comment_of(course, number, True)}")
        head = " " * len(head)
    return rows, index + STEP, course.values[-1]


def _positions(positions: Sequence[tuple[str, Array]]) -> list[str]:
    """Return the program lines that declare named joint positions, with JOINTS."""
    widest = max(len(name) for name, _ in positions)
    cells = rows_of(np.array([q for _, q in positions]), "JOINTS")
    return [
        f"JOINTS {name.upper():{widest}} {cell}" for (name, _), cell in zip(positions, cells, strict=True)
    ]


def _without_repeats(course: Course) -> Course:
    """Return the motion without targets that equal the target before them, unless they have a name."""
    moved = np.abs(np.diff(course.values, axis=0)).max(axis=1) > SAME_PLACE
    if course.names:
        moved |= np.array([bool(name) for name in course.names[1:]], dtype=bool)
    return course.only(np.flatnonzero(np.concatenate(([True], moved))))


def _about_times(course: Course, robot: Robot, wishes: Wishes) -> Iterator[str]:
    """Yield remarks about the times of a motion that goes through its targets without a stop."""
    if course.size < 3:
        return
    yield "All points are passed in one go: the arm speeds up once and slows down once."
    if course.target != "JOINTS":
        yield "From pose to pose the joints follow their spline, not a straight line of the tool."
        if course.times is not None:
            yield "The times between aren't kept: MOVEJ_TIMED, which keeps them, takes joint values."
        return
    if course.times is None or wishes.time is not None:
        return
    way = way_shares(course.values * robot.axis_units)
    asked = course.times - course.times[0]
    passed = _lspb_time(way) * asked[-1]
    worst = int(np.argmax(np.abs(passed - asked)))
    yield (
        f"The times between aren't kept; the greatest deviation: a point is passed at "
        f"{passed[worst]:.3f} s instead of "
        f"{asked[worst]:.3f} s after the start."
    )


def _lspb_time(way: Array) -> Array:
    """Return the times (w,) at which the LSPB motion profile has covered the fractions `way` (w,) of the
    path, relative to the time of the whole motion.

    The profile accelerates for a third of the time, moves at 1.5 times the mean speed for a third, and then
    decelerates.
    """
    from_end = np.minimum(way, 1.0 - way)
    early = np.where(
        from_end < 0.25, np.sqrt(np.maximum(from_end, 0.0) / 2.25), 1 / 3 + (from_end - 0.25) / 1.5
    )
    time: Array = np.where(way <= 0.5, early, 1.0 - early)
    return time


def _check_density(course: Course, robot: Robot, wishes: Wishes, findings: Collector) -> None:
    """Warn if the average time between waypoints is shorter than the controller's shortest segment."""
    if course.times is None or wishes.time is not None or course.size < 3:
        return
    gap = float(course.times[-1] - course.times[0]) / (course.size - 1)
    shortest = robot.controller.smallest_segment
    if gap >= shortest:
        return
    message = (
        f"the waypoints are {gap * 1e3:.3g} ms apart on average, less than the controller's shortest "
        f"segment of {shortest * 1e3:.3g} ms"
    )
    enough = math.ceil(shortest / gap)
    help_ = f"use fewer waypoints: --tolerance 0.05 (deg and mm), or --every {enough}"
    findings.add("Y1512", message, None, help_)


def _why_fewer(wishes: Wishes) -> str:
    """Return the reason why targets were omitted, in words."""
    parts = [f"one in {wishes.every}"] * (wishes.every > 1)
    if wishes.tolerance is not None:
        parts.append(f"the others are within {wishes.tolerance:g} (deg and mm) of the way")
    return f" ({', '.join(parts)})" if parts else " (the others repeat the one before)"
