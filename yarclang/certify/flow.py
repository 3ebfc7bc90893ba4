"""Check that a controller text does between its motions what its program says.

The dwells, outputs, waits and branches of a text must be those of the program, in the same order, and at
rest. The only exception from rest is an output after a motion that flows into the next one: it is set in the
middle of the blend.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from yarclang import hir
from yarclang.certify.read.text import Barred, ControllerText, Dwelt, Entry, Put, Run, Stood
from yarclang.certify.read.ways import Standing
from yarclang.decisions import KeptTo, Watch, called, in_words, inputs_of
from yarclang.handling.allowing import permitted
from yarclang.handling.keeping import kept_to
from yarclang.robot.model import Array
from yarclang.units import MS

Deed = tuple[object, ...]
"""An action: its kind, followed by its details."""
Fault = tuple[int | None, str]
"""The step of the program to which a fault belongs, if known, and the fault in words."""

SEGMENTS_OFF = 1
"""Largest number of segments between the middle of a blend and an output that counts as set in this middle.
"""
_SAME_TIME = 1e-6
_DECIMALS = 9
"""Number of decimals of input and output values in a text."""
_TIMES = {"dwell": (1,), "wait": (4,), "until": (3,), "when": (4,)}
"""For each kind of action, the indices of the times in its tuple: the duration of a dwell [ms], otherwise a
timeout [s].
"""
_LONGEST_NAME = 80
"""Largest number of characters of a name or text in a map."""


def check_flow(text: ControllerText, program: hir.Program) -> Iterator[Fault]:
    """Yield the differences between the declarations of the text and those of the program (such as safe
    values, registers and watched inputs), and the first difference between their actions.

    Args:
        text: the controller text, as the judge has read it.
        program: the program.
    """
    meant = {output.signal.variable: output.safe for output in program.outputs if output.safe is not None}
    if dict(text.outputs) != meant:
        yield None, "the safe values of the outputs aren't the program's"
    if text.registers != program.registers:
        yield None, "the registers, their ranges and first values aren't the program's"
    if text.watches != program.watches:
        yield None, f"the text watches {_watched(text.watches)}, and the program {_watched(program.watches)}"
    moving = {entry.step for entry in text.entries if entry.first}
    if text.searches != tuple(one for one in hir.searches_of(program) if one.step in moving):
        yield None, "other motions than the program's are ended by inputs, or by other inputs"
    shifts = tuple(replace(one, frame=_printable(one.frame)) for one in hir.offsets_of(program))
    if text.offsets != shifts:
        yield None, "other frames than the program's are shifted, or by other registers"
    allows = tuple(one for one in permitted(program) if one.step in moving)
    if text.allows != allows:
        # Report the first pair, in the order of the map, that only the text or only the program allows to
        # touch.
        wrong = min({*text.allows} ^ {*allows}, key=lambda one: (one.step, one.first, one.second))
        lets = "lets" if wrong in text.allows else "doesn't let"
        other = "doesn't" if wrong in text.allows else "does"
        yield wrong.step, f"the text {lets} {wrong.first} and {wrong.second} touch, and the program {other}"
    keeps = tuple(one for one in kept_to(program) if one.step in moving)
    if text.keeps != keeps:
        yield _other_rule(text.keeps, keeps)
    actions = list(_told(text))
    deeds = list(_meant(program, moving))
    for place, (step, deed) in enumerate(deeds):
        found = actions[place] if place < len(actions) else None
        if found is None or not _same(found, deed):
            yield step, f"the text does {_words(found)} where the program has {_words(deed)}"
            return
    if len(actions) > len(deeds):
        yield None, f"the text does {_words(actions[len(deeds)])} after the program's end"


def _other_rule(found: Sequence[KeptTo], wanted: Sequence[KeptTo]) -> tuple[int, str]:
    """Return the step of the first KEEP rule in which a text and a program differ, and the difference in
    words.
    """
    one = next((one for one in (*found, *wanted) if (one in found) != (one in wanted)), None)
    if one is None:
        return 0, "the text has the rules of KEEP in a different order than the program"
    others = wanted if one in found else found
    if any((other.step, other.words) == (one.step, one.words) for other in others):
        return one.step, f"KEEP {one.words} has other numbers in the text than in the program"
    has, lacks = ("text", "program") if one in found else ("program", "text")
    return one.step, f"the {has} has KEEP {one.words} here, and the {lacks} doesn't"


def _watched(watches: tuple[Watch, ...]) -> str:
    """Return in words the inputs that stop a motion, with their values and the branches they start."""
    told = (
        (
            f"{one.name} ({one.variable}) for "
            f"{one.value:g}{f' and leaves by {one.then} ({one.way})' if one.then else ''}"
        )
        for one in watches
    )
    return ", ".join(told) or "nothing"


def check_rests(text: ControllerText, start: Array, slack: Array) -> Iterator[Fault]:
    """Check the actions of a controller text as far as possible without its program.

    Outputs and barriers (waits, branches and ends of loops) must be at rest or in the middle of a blend. The
    goal of a slow RAPID must be the current position.

    Args:
        text: the controller text, as the judge has read it.
        start: (n,) joint positions at the start of the text [deg or mm].
        slack: (n,) largest allowed distance between the printed ends of two branches that meet [deg or mm].
    """
    yield from _not_at_rest(text)
    yield from _not_in_the_middle(text)
    yield from _out_of_order(text)
    yield from _stands_elsewhere(text, start, slack)
    yield from _decided_unread(text)
    yield from _after_an_end(text)
    yield from _searched_with_others(text)


def _searched_with_others(text: ControllerText) -> Iterator[Fault]:
    """Check that a motion with UNTIL, which an input ends, is the only motion between two barriers.

    The runtime streams all lines between two barriers together, and the input ends all of them.
    """
    ends = {entry.step: (entry.first or 0, entry.last or 0) for entry in text.entries}
    legs = [leg for leg in _legs(text) if leg]
    begins = [leg[0] for leg in legs]
    for one in text.searches:
        first, last = ends[one.step]
        # Legs are in the order of their lines, so the legs of a motion are neighbours.
        streamed = legs[bisect_right(begins, first) - 1 : bisect_right(begins, last)]
        if len(streamed) != 1 or not all(first <= line <= last for line in streamed[0]):
            yield one.step, f"a motion that {one.name} ends is streamed together with others"


def _legs(text: ControllerText) -> Iterator[list[int]]:
    """Yield, for each section of the text between two barriers, the numbers of the lines that move or set
    something.
    """
    leg: list[int] = []
    for item in (*text.course, None):
        if item is None or isinstance(item, Barred):
            yield leg
            leg = []
        elif isinstance(item, Run):
            leg += [int(line) for line in item.lines]
        elif isinstance(item, Put):
            leg.append(item.line)


def _meant(program: hir.Program, moving: set[int]) -> Iterator[tuple[int, Deed]]:
    """Yield the program's actions in order, each with its step.

    Motions of length zero are left out, since they have no lines in the text.
    """
    for number, step in enumerate(program.steps):
        if number in moving:
            yield number, ("move", number)
            continue
        match step:
            case hir.Stop():
                return
            case hir.Dwell(duration=duration):
                yield number, ("dwell", duration / MS)
            case hir.SetOutput(output=output, value=value):
                yield number, ("set", output.variable, value)
            case hir.WaitInput(input=signal, value=value, timeout=timeout):
                yield number, ("wait", number, signal.variable, value, timeout, _printable(signal.name))
            case hir.WaitUntil(condition=condition, timeout=timeout):
                yield number, ("until", number, condition, timeout, _printable(in_words(condition)))
            case hir.When(condition=condition, again=again, within=within):
                yield number, ("when", number, condition, again, within, _printable(called(condition)))
            case hir.Assign(target=target, value=result):
                called_, into = (
                    (target, target) if isinstance(target, str) else (target.name, target.variable)
                )
                name = _printable(f"{called_} = {in_words(result)}")
                yield number, ("assign", number, isinstance(target, str), into, result, name)
            case hir.Say(text=text):
                yield number, ("say", number, _printable(text))
            case hir.Hold(text=text, register=register):
                yield number, ("hold", number, register, _printable(text))
            case hir.Else():
                yield number, ("else", number)
            case hir.Loop():
                yield number, ("loop", number)
            case hir.NextPass():
                yield number, ("next", number)
            case hir.Exit():
                yield number, ("exit", number)
            case hir.EndLoop():
                yield number, ("endloop", number)
            case hir.EndWhen():
                yield number, ("end", number)
            case hir.Finish(fails=fails, text=said):
                yield number, ("abort", number, _printable(said)) if fails else ("stop", number)


def _told(text: ControllerText) -> Iterator[Deed]:
    """Yield the text's actions in order."""
    moving = iter([entry for entry in text.entries if entry.first is not None])
    entry = next(moving, None)
    for item in text.course:
        match item:
            case Run():
                puts = list(item.puts)
                # Assign the outputs of a sequence to the motions after which they are set.
                while entry is not None and (entry.first or 0) <= int(item.lines[-1]):
                    yield ("move", entry.step)
                    following = next(moving, None)
                    while puts and _belongs_after(item, puts[0], entry, following):
                        put = puts.pop(0)
                        yield ("set", put.variable, put.value)
                    entry = following
                for put in puts:
                    yield ("set", put.variable, put.value)
            case Dwelt(milliseconds=milliseconds) if milliseconds > 0.0:
                yield ("dwell", milliseconds)
            case Put(variable=variable, value=value):
                yield ("set", variable, value)
            case Barred(kind="when", decided=decided, again=again):
                yield ("when", item.step, decided, again, item.timeout, item.name)
            case Barred(kind="set", decided=decided, register=register, output=output):
                yield ("assign", item.step, not output, register or output, decided, item.name)
            case Barred(kind="wait", decided=decided) if decided is not None:
                yield ("until", item.step, decided, item.timeout, item.name)
            case Barred(kind="wait", condition=condition):
                name, _, wanted = condition.partition("=")
                yield (item.kind, item.step, name, float(wanted), item.timeout, item.name)
            case Barred(kind="hold"):
                yield (item.kind, item.step, item.register, item.name)
            case Barred(kind="abort" | "say"):
                yield (item.kind, item.step, item.name)
            case Barred():
                yield (item.kind, item.step)


def _printable(text: str) -> str:
    """Return a text as it is written in the map: ASCII, on one line, without quotes."""
    kept = "".join(one if " " <= one <= "~" and one != '"' else "?" for one in text)
    said = " ".join(kept.split())[:_LONGEST_NAME]
    return "" if said == "-" else said


def _behind(run: Run, put: Put, entry: Entry) -> int:
    """Return the number of segments from a command's end to the instant at which an output is set; negative
    if the output is set before the end.

    An output is set when the next move line's segment begins.
    """
    return int(
        np.searchsorted(run.lines, put.line) - np.searchsorted(run.lines, entry.last or 0, side="right")
    )


def _belongs_after(run: Run, put: Put, entry: Entry, following: Entry | None) -> bool:
    """Return True if an output is set near the end of a command, and the end of the next command is not
    nearer.

    The following command may be as short as one segment.
    """
    off = _behind(run, put, entry)
    if off > SEGMENTS_OFF:
        return False
    in_run = following is not None and (following.first or 0) <= int(run.lines[-1])
    return following is None or not in_run or abs(off) <= abs(_behind(run, put, following))


def _not_in_the_middle(text: ControllerText) -> Iterator[Fault]:
    """Report outputs that are set during a motion, but not in the middle of a blend."""
    for run in text.runs:
        if not run.puts:
            continue
        blended = [
            entry
            for entry in text.entries
            if entry.blend is not None and run.lines[0] <= (entry.last or 0) <= run.lines[-1]
        ]
        for put in run.puts:
            if not blended:
                yield (
                    None,
                    f"line {put.line} sets {put.variable} while the robot moves, outside of any blend",
                )
                continue
            off = min((_behind(run, put, entry) for entry in blended), key=abs)
            if abs(off) > SEGMENTS_OFF:
                there = f"{abs(off)} segments {'after' if off > 0 else 'before'} the middle of the blend"
                yield None, f"line {put.line} sets {put.variable} {there}"


def _same(found: Deed, deed: Deed) -> bool:
    if found == deed:
        return True
    if len(found) != len(deed):
        return False
    times = _TIMES.get(str(deed[0]), ())
    return all(
        _same_number(a, b, is_time=at in times) if isinstance(a, float) and isinstance(b, float) else a == b
        for at, (a, b) in enumerate(zip(found, deed, strict=True))
    )


def _same_number(found: float, meant: float, *, is_time: bool) -> bool:
    """Return True if the text has the program's number.

    A time must agree to the printed precision, and a value to its last decimal: the runtime compares the
    value of a WAIT exactly, so any other value would be another condition.
    """
    if is_time:
        return abs(found - meant) <= _SAME_TIME * max(1.0, abs(meant))
    return found == round(meant, _DECIMALS)


def _words(deed: Deed | None) -> str:
    if deed is None:
        return "nothing"
    if deed[0] in ("when", "assign", "until"):
        return f"{deed[0]} {deed[1]} {deed[-1] or '-'}"
    return " ".join(str(part) for part in deed if part is not None)


def _not_at_rest(text: ControllerText) -> Iterator[Fault]:
    """Report outputs and barriers during a motion, and RAPIDs that are not after a barrier."""
    before: object = None
    for item in text.course:
        if isinstance(item, Put | Barred) and isinstance(before, Run):
            yield None, f"line {item.line} comes while the robot moves: there is no DWELL before it"
        if isinstance(item, Stood) and not isinstance(before, Barred):
            yield None, f"line {item.line} is a RAPID, which is allowed only after a barrier"
        before = item


def _out_of_order(text: ControllerText) -> Iterator[Fault]:
    """Report moves and barriers that are not in the order of the map's steps."""
    steps = [deed[1] for deed in _told(text) if deed[0] not in ("set", "dwell")]
    for one, other in pairwise(steps):
        if not one < other:  # type: ignore[operator]  # each is the number of a step
            yield None, f"the text carries out command {other} of the map after command {one}"
            return


def _decided_unread(text: ControllerText) -> Iterator[Fault]:
    """Report decisions that reuse input values without being allowed to.

    A decision may reuse only the values that the innermost open WHEN has read (or itself reused), and only
    directly after the start of this WHEN's second branch.
    """
    read: list[set[str]] = []
    before: Barred | None = None
    for item in text.course:
        if not isinstance(item, Stood):
            if isinstance(item, Barred) and item.again and item.decided is not None:
                needed = {one.variable for one in inputs_of(item.decided)}
                if before is None or before.kind != "else" or not read or not needed <= read[-1]:
                    yield None, f"line {item.line} decides by inputs that weren't read before it"
            before = item if isinstance(item, Barred) else None
        if isinstance(item, Barred) and item.kind == "when" and item.decided is not None:
            # Remember the inputs that were read at each open WHEN, the innermost one last.
            known = read[-1] if item.again and read else {one.variable for one in inputs_of(item.decided)}
            read.append(known)
        elif isinstance(item, Barred) and item.kind == "end" and read:
            read.pop()


def _after_an_end(text: ControllerText) -> Iterator[Fault]:
    """Report actions that come after the end of the program, or of a pass of a loop, in the same branch.

    Such actions would never be streamed. The last barrier of a branch shows if it ends the program or the
    pass.
    """
    ended: Barred | None = None
    for item in text.course:
        if ended is not None and not isinstance(item, Stood):
            if not isinstance(item, Barred) or item.kind not in ("else", "end", "endloop"):
                what = "the program" if ended.kind in ("stop", "abort") else "a pass of a loop"
                yield None, f"line {ended.line} ends {what}, but its branch continues after it"
                return
            ended = None
        if isinstance(item, Barred) and item.kind in ("stop", "abort", "next", "exit"):
            ended = item


def _stands_elsewhere(text: ControllerText, start: Array, slack: Array) -> Iterator[Fault]:
    """Report places in a text at which joint positions don't match.

    The goal of a slow RAPID must be the current position; the branches of a WHEN and the exits of a loop must
    end at the same position; a pass of a loop must end where the first pass begins.
    """
    standing = Standing(start)
    for item in text.course:
        match item:
            case Run(points=points):
                standing.at = points[-1]
            case Stood(line=line, point=point):
                if (np.abs(point - standing.at) > slack).any():
                    yield None, f"line {line + 2} moves away from the robot's position"
                standing.at = point
            case Barred(kind=kind, line=line):
                try:
                    met = standing.pass_(kind)
                except ValueError as error:
                    yield None, f"line {line}: {error}"
                    return
                if met is not None and (np.abs(met[0] - standing.at) > slack).any():
                    yield None, f"{met[1]} (line {line})"
    if standing.open:
        yield None, "a loop has no end" if standing.open[-1].begins else "a branch of a WHEN has no end"
