"""Reading of the comments at the top of a controller text: header, and map of commands and barriers."""

from __future__ import annotations

import re
from collections.abc import Container, Mapping
from sys import intern

from yarclang.certify.read.deciding import read_assignment, read_condition, read_value
from yarclang.certify.read.lines import Lines, Refusal, check_characters, shown
from yarclang.certify.read.text import Barred, Entry, Unreadable
from yarclang.decisions import (
    AGAIN,
    LARGEST,
    LONGEST_NAME,
    MOST_WATCHES,
    InputValue,
    KeptTo,
    Permitted,
    Register,
    RegisterValue,
    Searched,
    Shifted,
    Value,
    Watch,
    inputs_of,
    registers_of,
)
from yarclang.emitted.bounds import MOST_SEARCHES
from yarclang.emitted.header import COLUMNS, Header
from yarclang.emitted.quoting import unquoted
from yarclang.frozen import frozen
from yarclang.lasting import ONCE, Lasting

_FIRST = re.compile(r"; yarcc (\S{1,40}): (.*)")
_TARGET = re.compile(r"; target ([a-z]{1,20})")
_ROBOT = re.compile(r"; robot (\S+) ([0-9a-f]{64})")
_PROGRAM = re.compile(r"; program ([0-9a-f]{64})")
_MADE_WITH = re.compile(r"; made with (.*)")
_START = re.compile(r"; start ([-A-Z0-9.]+) \((.*)\)")
_TIME = r"[0-9]{1,4}(?:\.[0-9]{1,12})?"
_SECONDS = r"[0-9]{1,9}\.[0-9]{3}"
_DURATION = re.compile(
    rf"; duration (?:({_SECONDS}) to )?({_SECONDS}) s(?: and "
    rf"(?:([0-9]{{1,9}}) to )?([0-9]{{1,9}}) waits?)?(, {ONCE})?(?:, segments of ({_TIME})"
    rf"(?: to ({_TIME}))? ms)?"
)
_LONGEST = re.compile(rf"; longest segment asked for ({_TIME}) ms")
_SEARCHES = re.compile(r"; ways round: the quickest of ([1-9][0-9]?) searches")
_LOADING = re.compile(r"; (loading .{1,200})")
_CERTIFICATE = re.compile(r"; certificate (.*)")
_SEAL = re.compile(r"; sha256 (-|[0-9a-f]{64})")

_ENTRY = re.compile(
    r"; command ([0-9]{1,9}) (\S+) (\S+) ([0-9]{1,9}) "
    r"(?:([0-9]{1,9}) ([0-9]{1,9})(?: blend ([0-9]{1,6}))?( any-jerk)?|- -)"
)
_BARRIER = re.compile(
    r"; barrier ([0-9]{1,9}) (wait|hold|when|else|end|set|stop|abort|say|loop|next|exit"
    r"|endloop) ([0-9]{1,9}) (\S{1,4000}) (-|[0-9]{1,9}(?:\.[0-9]{1,13})?(?:e[+-][0-9]{1,2})?) (.+)"
)
_NAMELESS = ("else", "end", "stop", "loop", "next", "exit", "endloop")
_WAITED = re.compile(r"[MPQ][0-9]{1,4}=-?[0-9]{1,10}(?:\.[0-9]{1,9})?")
_INTEGER = r"(0|-?[1-9][0-9]{0,9})"
_REGISTER = re.compile(
    rf"; register ([A-Z_][A-Z0-9_]{{0,{LONGEST_NAME - 1}}}) {_INTEGER} {_INTEGER} {_INTEGER}( kept| outside)?"
)

_WATCH = re.compile(
    r"; watch ([MPQ][0-9]{1,4})=(0|-?(?!0 )(?:0|[1-9][0-9]{0,9})"
    r"(?:\.[0-9]{0,8}[1-9])?) ([A-Z_][A-Z0-9_.]{0,79})(?: then ([A-Z_][A-Z0-9_.]{0,79}) ([0-9a-f]{16}))?"
)

_SEARCH = re.compile(
    r"; search ([0-9]{1,7}) ([MPQ][0-9]{1,4})=(0|-?(?!0 )(?:0|[1-9][0-9]{0,9})(?:\.[0-9]{0,8}[1-9])?) "
    r"([A-Z_][A-Z0-9_.]{0,79}) ([A-Z_][A-Z0-9_]{0,39}) (-|[A-Z_][A-Z0-9_]{0,39})"
)

_OFFSET = re.compile(
    r"; offset ([0-9]{1,7}) ([A-Z_][A-Z0-9_]{0,39}) ((?:(?:-|[A-Z_][A-Z0-9_]{0,39}) ){4})"
    r"((?! )[ -~]{1,80}(?<! ))"
)

_KEEP = re.compile(r"; keep ([0-9]{1,7}) ([!-~]{1,900})")
_ALLOW = re.compile(r"; allow ([0-9]{1,7}) ([!-~]{1,400}) ([!-~]{1,400})")


@frozen
class Preamble:
    """The comments at the top of a controller text, before the first line that the controller reads.

    Attributes:
        header: the header.
        entries: the commands in the map, with their lines.
        barriers: the barriers in the map (waits, branches, loops), by their lines.
        registers: the registers that the runtime keeps.
        watches: inputs that stop the motion while they have a stated value.
        searches: motions that an input ends.
        offsets: branches that are planned and proved when the program runs, in a shifted frame.
        allows: pairs of bodies that are allowed to touch, by motion.
        keeps: rules (KEEP) that motions respect.
    """

    header: Header
    entries: tuple[Entry, ...]
    barriers: dict[int, Barred]
    registers: tuple[Register, ...] = ()
    watches: tuple[Watch, ...] = ()
    searches: tuple[Searched, ...] = ()
    offsets: tuple[Shifted, ...] = ()
    allows: tuple[Permitted, ...] = ()
    keeps: tuple[KeptTo, ...] = ()


def header_of(text: str) -> Preamble | Unreadable:
    """Read only the comments at the top of a controller text, without knowing the robot.

    Args:
        text: a text written by yarcc.

    Returns:
        The comments, or the first line that differs from what yarcc writes.
    """
    try:
        check_characters(text)
        return read_preamble(Lines(text))
    except Refusal as refusal:
        return Unreadable(*refusal.args)


def read_preamble(lines: Lines) -> Preamble:
    """Read the comments at the top of a controller text, from the first line on.

    Raises:
        Refusal: a line differs from what yarcc writes in its place.
    """
    header = _read_header(lines)
    entries: list[Entry] = []
    while lines.peek().startswith("; command"):
        entries.append(_read_entry(lines))
    barriers: dict[int, Barred] = {}
    still = {entry.step for entry in entries if entry.first is None}
    while lines.peek().startswith("; barrier"):
        barrier = _read_barrier(lines)
        if barrier.line in barriers:
            lines.refuse(f"names a second barrier for line {barrier.line}", back=1)
        if barrier.step not in still:
            lines.refuse(
                f"gives a barrier to command {barrier.step}: the map has no such command without moves",
                back=1,
            )
        still.remove(barrier.step)
        barriers[barrier.line] = barrier
    registers = _read_registers(lines, barriers)
    watches = _read_watches(lines)
    moves = {one.step for one in entries if one.first}
    searches = _read_searches(lines, moves, registers)
    offsets = _read_offsets(lines, barriers, registers, {one.flag for one in searches})
    allows = _read_allows(lines, moves)
    keeps = _read_keeps(lines, moves)
    if lines.peek().startswith(";"):
        lines.refuse(f"is {shown(lines.peek())}: no line of the map of commands")
    return Preamble(header, tuple(entries), barriers, registers, watches, searches, offsets, allows, keeps)


def _read_header(lines: Lines) -> Header:
    version, source = _matched(lines, _FIRST, "the name of the program")
    (target,) = _matched(lines, _TARGET, "the target")
    robot, robot_fingerprint = _matched(lines, _ROBOT, "the robot")
    (program,) = _matched(lines, _PROGRAM, "the program's hash")
    (made_with,) = _matched(lines, _MADE_WITH, "what the text was made with")
    start, units = _matched(lines, _START, "the start")
    shortest, known, fewest, waits, once, least, most = _matched(lines, _DURATION, "the duration")
    longest = ""
    if lines.peek().startswith("; longest"):
        (longest,) = _matched(lines, _LONGEST, "the longest segment that was asked for")
    searches = 1
    if lines.peek().startswith("; ways round"):
        searches = int(_matched(lines, _SEARCHES, "the number of searches for ways round")[0])
        if not 2 <= searches <= MOST_SEARCHES:
            lines.refuse(
                f"says that {searches} searches were made, which is not between 2 and {MOST_SEARCHES}", back=1
            )
    (loading,) = _matched(lines, _LOADING, "what loading does")
    if (line := lines.peek()) != f"; {COLUMNS}":
        lines.refuse(f"is {shown(line)}; expected: the first line of the map of commands")
    lines.skip()
    (certificate,) = _matched(lines, _CERTIFICATE, "the certificate's summary")
    (seal,) = _matched(lines, _SEAL, "the seal")
    return Header(
        version=version,
        source=source,
        target=target,
        loading=loading,
        robot=robot,
        robot_fingerprint=robot_fingerprint,
        program_fingerprint=program,
        made_with=made_with,
        start=start,
        units=units,
        lasting=Lasting(
            float(shortest or known), float(known), int(fewest or waits or 0), int(waits or 0), bool(once)
        ),
        segments=tuple(one for one in (least, most) if one),
        longest=longest,
        searches=searches,
        certificate=certificate,
        seal=seal,
    )


def _matched(lines: Lines, form: re.Pattern[str], what: str) -> tuple[str, ...]:
    """Return the groups of the next line, which must match a pattern; groups without a match are empty."""
    line = lines.peek()
    found = form.fullmatch(line)
    if found is None:
        lines.refuse(f"is {shown(line)}; expected in the header: {what}")
    lines.skip()
    return tuple(one or "" for one in found.groups())


def _read_entry(lines: Lines) -> Entry:
    at = lines.line
    matched = _ENTRY.fullmatch(lines.peek())
    if matched is None:
        lines.refuse(f"is no line of the map of commands: {shown(lines.peek())}")
    lines.skip()
    step, index, name, source_line, first, last, blend, any_jerk = matched.groups()
    return Entry(
        at,
        int(step),
        "" if index == "-" else index,
        intern(name),
        int(source_line),
        int(first) if first else None,
        int(last) if last else None,
        int(blend) if blend else None,
        bool(any_jerk),
    )


def _read_barrier(lines: Lines) -> Barred:
    matched = _BARRIER.fullmatch(lines.peek())
    if matched is None:
        lines.refuse(f"is no line of the map of barriers: {shown(lines.peek())}")
    line, kind, step, condition, timeout, name = matched.groups()
    decided, again, target = _decided(lines, kind, condition)
    if timeout != "-" and (kind not in ("wait", "when") or condition.startswith(AGAIN)):
        lines.refuse(f"names a time that no '{kind}' has: {shown(lines.peek())}")
    if name != "-" and kind in _NAMELESS:
        lines.refuse(f"gives a name to a barrier that has none: {shown(lines.peek())}")
    lines.skip()
    seconds = None if timeout == "-" else float(timeout)
    name = "" if name == "-" else name
    register = target.name if isinstance(target, RegisterValue) else ""
    output = target.variable if isinstance(target, InputValue) else ""
    return Barred(int(line), kind, int(step), condition, seconds, name, decided, again, register, output)


def _decided(
    lines: Lines, kind: str, condition: str
) -> tuple[Value | None, bool, RegisterValue | InputValue | None]:
    """Read what a barrier decides or assigns.

    Returns:
        The condition or value; True if the condition uses the input values of an earlier decision; and the
        register or output that the barrier sets.
    """
    if kind == "when":
        again = condition.startswith(AGAIN)
        found = read_condition(condition.removeprefix(AGAIN))
        if found is not None:
            return found, again, None
    elif kind == "set":
        assigned = read_assignment(condition)
        if assigned is not None:
            return assigned[1], False, assigned[0]
    elif kind == "hold" and condition != "-":
        asked = read_value(condition)
        if isinstance(asked, RegisterValue):
            return None, False, asked
    elif kind == "wait" and _WAITED.fullmatch(condition) is None:
        found = read_condition(condition)
        if found is not None and (inputs_of(found) or registers_of(found)):
            return found, False, None
    elif (_WAITED.fullmatch(condition) is not None) if kind == "wait" else condition == "-":
        return None, False, None
    raise Refusal(lines.line, f"names a condition that no '{kind}' has: {shown(lines.peek())}", "Y1151")


def _can_change(condition: Value, registers: Mapping[str, Register]) -> bool:
    """Return True if a condition may change while a program waits.

    It may change by an input, or by a register that is set from outside of the program.
    """
    return bool(inputs_of(condition)) or any(
        name in registers and registers[name].outside for name in registers_of(condition)
    )


def _read_registers(lines: Lines, barriers: Mapping[int, Barred]) -> tuple[Register, ...]:
    """Read the registers that the runtime keeps, and check that each one in use is declared."""
    registers: dict[str, Register] = {}
    while lines.peek().startswith("; register"):
        matched = _REGISTER.fullmatch(lines.peek())
        if matched is None:
            lines.refuse(f"is no line of the map of registers: {shown(lines.peek())}")
        name, low, high, first = matched[1], int(matched[2]), int(matched[3]), int(matched[4])
        if name in registers or not -LARGEST <= low <= first <= high <= LARGEST:
            lines.refuse(f"isn't a register, or repeats one: {shown(lines.peek())}")
        registers[name] = Register(name, low, high, first, matched[5] == " kept", matched[5] == " outside")
        lines.skip()
    for barrier in barriers.values():
        if (
            barrier.kind == "wait"
            and barrier.decided is not None
            and not _can_change(barrier.decided, registers)
        ):
            lines.refuse(f"comes too late: line {barrier.line} waits for a value that nothing changes")
        used = () if barrier.decided is None else registers_of(barrier.decided)
        for name in (*used, *([barrier.register] if barrier.register else [])):
            if name not in registers:
                lines.refuse(
                    f"comes where the map of registers ends without {name}, which line {barrier.line} uses"
                )
    return tuple(registers.values())


def _read_watches(lines: Lines) -> tuple[Watch, ...]:
    """Read the inputs that stop the motion while they have a stated value. The same value of an input may be
    listed only once.
    """
    watches: list[Watch] = []
    while lines.peek().startswith("; watch"):
        matched = _WATCH.fullmatch(lines.peek())
        if matched is None:
            lines.refuse(f"is no line of the map of watches: {shown(lines.peek())}")
        watch = Watch(matched[1], float(matched[2]), matched[3], matched[4] or "", matched[5] or "")
        if len(watches) == MOST_WATCHES or any(
            (one.variable, one.value) == (watch.variable, watch.value) for one in watches
        ):
            lines.refuse(f"watches an input twice, or more than {MOST_WATCHES} inputs: {shown(lines.peek())}")
        watches.append(watch)
        lines.skip()
    return tuple(watches)


def _read_searches(
    lines: Lines, moves: Container[int], registers: tuple[Register, ...]
) -> tuple[Searched, ...]:
    """Read the motions that an input ends, in order.

    Each motion has a register of its own, its flag, which becomes 1 when the input ends the motion.
    """
    searches: list[Searched] = []
    flags = {one.name for one in registers if (one.low, one.high, one.first, one.kept) == (0, 1, 0, False)}
    known = {"-", *(one.name for one in registers)}
    while lines.peek().startswith("; search"):
        matched = _SEARCH.fullmatch(lines.peek())
        if matched is None:
            lines.refuse(f"is no line of the map of searches: {shown(lines.peek())}")
        step, depth = int(matched[1]), matched[6]
        if step not in moves or (searches and searches[-1].step >= step):
            lines.refuse(f"ends a command that doesn't move, or is out of order: {shown(lines.peek())}")
        if matched[5] not in flags or depth not in known or depth == matched[5]:
            lines.refuse(f"names no registers for what is found: {shown(lines.peek())}")
        flags.remove(matched[5])
        searches.append(
            Searched(
                step, matched[2], float(matched[3]), matched[4], matched[5], "" if depth == "-" else depth
            )
        )
        lines.skip()
    return tuple(searches)


def _read_offsets(
    lines: Lines, barriers: Mapping[int, Barred], registers: tuple[Register, ...], used: Container[str]
) -> tuple[Shifted, ...]:
    """Read the branches in which a frame is shifted, in order.

    Each branch is decided by a register of its own, its flag. Nothing else may set the flag or depend on it.

    Args:
        lines: the text.
        barriers: the barriers of the map.
        registers: the registers of the map.
        used: flags of searches, which shifts must not use.
    """
    offsets: list[Shifted] = []
    known = {one.name: one for one in registers}
    while lines.peek().startswith("; offset"):
        matched = _OFFSET.fullmatch(lines.peek())
        if matched is None:
            lines.refuse(f"is no line of the map of offsets: {shown(lines.peek())}")
        step, flag = int(matched[1]), matched[2]
        names = tuple("" if one == "-" else one for one in matched[3].split())
        # The branch itself must be a WHEN on the flag, without a time limit, and the only barrier that uses
        # the flag.
        at = [one for one in barriers.values() if one.step == step and one.kind == "when"]
        if not at or (offsets and offsets[-1].step >= step):
            lines.refuse(
                f"shifts a frame where nothing is decided, or is out of order: {shown(lines.peek())}"
            )
        register = known.get(flag)
        others = [
            one
            for one in barriers.values()
            if one is not at[0]
            and (one.register == flag or (one.decided is not None and flag in registers_of(one.decided)))
        ]
        if (
            register is None
            or (register.low, register.high, register.first, register.kept, register.outside)
            != (0, 1, 0, False, False)
            or flag in used
            or others
            or any(one.flag == flag for one in offsets)
            or (at[0].condition, at[0].timeout) != (f"${flag}=1", None)
        ):
            lines.refuse(f"isn't decided by a flag of its own: {shown(lines.peek())}")
        given = [one for one in names if one]
        if (
            not given
            or len(set(given)) != len(given)
            or not all(
                one in known and one != flag and known[one].low <= 0 <= known[one].high for one in given
            )
        ):
            lines.refuse(f"names no registers that can shift a frame: {shown(lines.peek())}")
        offsets.append(Shifted(step, flag, matched[4], names))
        lines.skip()
    return tuple(offsets)


def _read_allows(lines: Lines, moves: Container[int]) -> tuple[Permitted, ...]:
    """Read the pairs of bodies that are allowed to touch, sorted by motion and then by name."""
    allows: list[Permitted] = []
    while lines.peek().startswith("; allow"):
        matched = _ALLOW.fullmatch(lines.peek())
        first, second = (None, None) if matched is None else (unquoted(matched[2]), unquoted(matched[3]))
        if matched is None or first is None or second is None:
            lines.refuse(f"is no line of the map of bodies that may touch: {shown(lines.peek())}")
        one = Permitted(int(matched[1]), first, second)
        last = allows[-1] if allows else None
        in_order = last is None or (last.step, last.first, last.second) < (one.step, one.first, one.second)
        if one.step not in moves or one.first > one.second or not in_order:
            lines.refuse(
                f"lets bodies touch on a command that doesn't move, or is out of order: {shown(lines.peek())}"
            )
        allows.append(one)
        lines.skip()
    return tuple(allows)


def _read_keeps(lines: Lines, moves: Container[int]) -> tuple[KeptTo, ...]:
    """Read the rules (KEEP) that motions respect, sorted by motion, each rule at most once for each
    motion.
    """
    keeps: list[KeptTo] = []
    while lines.peek().startswith("; keep"):
        matched = _KEEP.fullmatch(lines.peek())
        rule = None if matched is None else unquoted(matched[2])
        if matched is None or rule is None:
            lines.refuse(f"is no line of the map of rules that motions keep to: {shown(lines.peek())}")
        one = KeptTo(int(matched[1]), rule)
        if one.step not in moves or (keeps and keeps[-1].step > one.step) or one in keeps[-_MOST_KEEPS:]:
            lines.refuse(
                "is a rule for a command that doesn't move, is given twice, or is out of order: "
                f"{shown(lines.peek())}"
            )
        keeps.append(one)
        lines.skip()
    return tuple(keeps)


_MOST_KEEPS = 100
"""Number of preceding lines that must not contain the same rule of the same motion.

A motion can't have more rules, since blocks can't be nested deeper.
"""
