"""Reader for the changes of inputs in a script file of a simulated cell. It converts the TOML file to
changes, or to findings that refer to lines of the file.

Pydantic is imported at its first use.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import field, replace
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

from yarclang.cell.model import Cell
from yarclang.decisions import bits_of, group_of, inputs_of, is_group, largest_of
from yarclang.diagnostics import Diagnostic, Result, has_errors, in_order
from yarclang.frozen import frozen
from yarclang.hir import (
    Assign,
    Gap,
    Hold,
    Motion,
    Program,
    SetOutput,
    Signal,
    Step,
    WaitInput,
    WaitUntil,
    When,
    searches_of,
)
from yarclang.robot.controller import SignalVariable
from yarclang.robot.kinds import known_signal
from yarclang.source import SourceFile
from yarclang.toml.file import TomlFile, did_you_mean
from yarclang.toml.places import Path, find_places
from yarclang.toml.reading import parse_toml, read_text

if TYPE_CHECKING:
    from yarclang.simulated_cell.schema import InputTable

_LARGEST_SCRIPT = 1_000_000
"""Largest number of characters of a script."""

_STATES = {"ON": 1.0, "OFF": 0.0}


@frozen
class Change:
    """A change of an input that a script makes after one of three events: a time, a command, or a change of
    an output.

    Attributes:
        variable: variable of the input in the controller.
        value: new value of the input.
        at: time of the event after the start of the run [s]; None for another event.
        place: index or full place of the command whose beginning is the event; None for another event.
        output: variable of an output, and the value whose assignment is the event; None for another event.
        delay: time from the event to the change [s].
        toggle: times for which the input alternately has the value and its opposite [s]; None if it keeps the
            value.
        stuck: True if nothing else changes the input from then on.
    """

    variable: str
    value: float
    at: float | None = None
    place: str | None = None
    output: tuple[str, float] | None = None
    delay: float = 0.0
    toggle: tuple[float, float] | None = None
    stuck: bool = False


@frozen
class Known:
    """The names that a script may use.

    Attributes:
        inputs: variables of inputs in the controller, by their names in upper case.
        outputs: variables of outputs in the controller, by their names in upper case.
        places: full places of the program's commands, such as P0020(I=2)>P0010; None if the program isn't
            known yet. Only commands whose beginning a run reports: motions, waits for inputs, and holds.
        unseen: full places of the program's other commands.
        has_places: False if no program will ever be run, so that a script can't name a command.
        signal: function that parses a text in upper case as the variable of an input or output.
        groups: variables of each group of inputs by the group's name, lowest bit first. The bits (JOB.0 and
            so on) are also in `inputs`.
        registers: registers for which the program accepts values from other processes; None if the program
            isn't known yet.
    """

    inputs: Mapping[str, str]
    outputs: Mapping[str, str]
    places: frozenset[str] | None = None
    unseen: frozenset[str] = frozenset()
    has_places: bool = True
    signal: Callable[[str], SignalVariable] = known_signal
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    registers: frozenset[str] | None = None


def known_in(
    program: Program | None, cell: Cell | None, signal: Callable[[str], SignalVariable] = known_signal
) -> Known:
    """Return the names that a program and a cell declare. If both declare a name, that of the program is
    used.
    """
    inputs: dict[str, str] = {}
    outputs: dict[str, str] = {}
    places, unseen = set[str](), set[str]()
    groups: dict[str, tuple[str, ...]] = {}
    if cell is not None:
        inputs.update(cell.inputs)
        outputs.update({name: one.variable for name, one in cell.outputs.items()})
    if program is None:
        return Known(inputs, outputs, None, signal=signal)
    for declared in program.outputs:
        outputs[declared.signal.name.upper()] = declared.signal.variable
    inputs |= {watch.name.upper(): watch.variable for watch in program.watches}
    inputs |= {one.name.upper(): one.variable for one in searches_of(program)}
    for step in program.steps:
        if isinstance(step, Gap):
            continue
        if step.origin.label:
            (places if _is_reported(step) else unseen).add(step.origin.label)
        if isinstance(step, WaitInput):
            inputs[step.input.name.upper()] = step.input.variable
        elif isinstance(step, When | WaitUntil | Assign):
            for read in inputs_of(step.value if isinstance(step, Assign) else step.condition):
                signal_read = Signal(read.name.upper(), read.variable)
                inputs |= {bit.name: bit.variable for bit in signal_read.bits}
                if is_group(read.variable):
                    groups[signal_read.name] = bits_of(read.variable)
        elif isinstance(step, SetOutput):
            outputs[step.output.name.upper()] = step.output.variable
    registers = frozenset(one.name for one in program.registers if one.outside)
    return Known(
        inputs,
        outputs,
        frozenset(places),
        frozenset(unseen),
        signal=signal,
        groups=groups,
        registers=registers,
    )


def _is_reported(step: Step) -> bool:
    """Return True if a run reports the beginning of a command."""
    if isinstance(step, When):
        return step.within is not None
    return isinstance(step, Motion | WaitInput | WaitUntil | Hold)


def load_script(path: FilePath, known: Known) -> Result[tuple[Change, ...]]:
    """Read the changes of inputs in a script file.

    Returns:
        The changes, or None with findings. A missing file is a finding without a position.
    """
    source = read_text(path, "Name a script of inputs, a TOML file.")
    if isinstance(source, Diagnostic):
        return Result(None, (source,))
    return read_script(source, known)


def read_script(source: SourceFile, known: Known) -> Result[tuple[Change, ...]]:
    """Read the changes of inputs in the text of a script.

    Returns:
        The changes, or None with findings.
    """
    from yarclang.simulated_cell.schema import ScriptTable
    from yarclang.toml.draft import read_draft

    if len(source.text) > _LARGEST_SCRIPT:
        message = f"The script has {len(source.text):,} characters, at most {_LARGEST_SCRIPT:,} are read."
        return Result(None, (Diagnostic("Y1302", message, help="Name a script of inputs, a TOML file."),))
    data = parse_toml(source)
    if isinstance(data, Diagnostic):
        return Result(None, (data,))
    file = TomlFile(source, find_places(source))
    draft = read_draft(_spelled_out(data), ScriptTable)
    draft.tell(file)
    broken = {path[:2] for path in draft.dropped}
    changes: list[Change] = []
    stuck: set[str] = set()
    for number, table in enumerate(draft.table.inputs):
        path: Path = ("inputs", number)
        if path in broken or table.input is None or table.to is None:
            continue
        change = _change(table, path, known, file)
        if change is None:
            continue
        if change.stuck and change.variable in stuck:
            message = f"{table.input[:40]} is stuck already: nothing changes it a second time."
            file.say("Y1618", (*path, "stuck"), message, "Remove one of both.", at_key=True)
        if change.stuck:
            stuck.add(change.variable)
        changes += _of_bits(change)
    found = in_order(file.findings)
    return Result(None if has_errors(found) else tuple(changes), found)


def _of_bits(change: Change) -> tuple[Change, ...]:
    """Convert a change of a group of inputs to simultaneous changes of the group's bits. Return the change of
    a single input as it is.
    """
    if not is_group(change.variable):
        return (change,)
    return tuple(
        replace(change, variable=bit, value=float(int(change.value) >> place & 1))
        for place, bit in enumerate(bits_of(change.variable))
    )


def _group_fault(name: str, variable: str, number: float, *, toggles: bool = False) -> str:
    """Return the reason why a group can't have a value or can't toggle; empty if it can."""
    if not is_group(variable):
        return ""
    if toggles:
        return f"{name} is a group of bits, and only a single input toggles."
    if number.is_integer() and 0 <= number <= largest_of(variable):
        return ""
    return (
        f"{name} is {number:.15g}, but a group of {len(bits_of(variable))} bits is an integer from 0 to "
        f"{largest_of(variable)}."
    )


def read_setting(text: str, known: Known) -> Result[tuple[Change, ...]]:
    """Read the initial value of an input, or of each bit of a group, from a text such as `CLAMP=1`.

    Returns:
        The changes, or None with a finding.

    Raises:
        ValueError: the text has another form.
    """
    name, number = check_setting(text)
    variable = input_variable(name, known)
    if isinstance(variable, Diagnostic):
        return Result(None, (variable,))
    if fault := _group_fault(name[:40], variable, number):
        return Result(None, (Diagnostic("Y1618", fault, help="Check the number."),))
    return Result(_of_bits(Change(variable, number, at=0.0)))


def check_setting(text: str) -> tuple[str, float]:
    """Split a text such as `CLAMP=1`, and return the name and the value.

    Raises:
        ValueError: the text has another form.
    """
    name, equals, value = text.partition("=")
    number = value_of(value)
    if not equals or number is None or not name.strip():
        raise ValueError(f"{text[:80]!r} isn't INPUT=ON, INPUT=OFF or INPUT=NUMBER")
    return name, number


def value_of(text: str) -> float | None:
    """Return the value of ON, OFF or a number; None for another text."""
    word = text.strip().upper()
    if word in _STATES:
        return _STATES[word]
    try:
        number = float(word)
    except ValueError:
        return None
    return number if abs(number) <= 1e9 else None


def input_variable(text: str, known: Known) -> str | Diagnostic:
    """Return the variable of an input, or the variables of all bits of a group; a finding without a position
    if there is none.

    Args:
        text: name or variable of the input, or name of the group.
        known: names of inputs and groups.
    """
    name = text.strip().upper()
    shown = name[:40]
    if name in known.inputs:
        return known.inputs[name]
    if name in known.groups:
        return group_of(known.groups[name])
    if name in known.outputs:
        return Diagnostic("Y1618", f"{shown} is an output, which the program sets.", help="Name an input.")
    variable = known.signal(name)
    if variable.name is None:
        if variable.is_taken:
            remedy = f"{variable.remedy.capitalize()}."
            return Diagnostic("Y0413", f"{shown} {variable.fault}.", help=remedy)
        remedy, subject = did_you_mean(name, (*known.inputs, *known.groups))
        remedy = f"{remedy} A variable such as M11 is an input as well."
        return Diagnostic("Y1617", f"No input is named {shown}.", help=remedy, subject=subject)
    if variable.name in known.outputs.values():
        output = next(one for one, its in known.outputs.items() if its == variable.name)
        message = f"{shown} is the output {output}, which the program sets."
        return Diagnostic("Y1618", message, help="Name an input.")
    return variable.name


def is_reached(wanted: str, place: str, before: str = "") -> bool:
    """Return True if a program has reached the command that a script names.

    An index alone, such as P0020, names each command with this index, in each pass of a loop. If the command
    is a call, it is reached at the first command within the called SUB, such as P0020(I=2)>P0010. An index
    after `>`, such as >P0010, names each command with this index in any SUB, such as P0020(I=2)>P0010.

    Args:
        wanted: the name in the script: an index or the full place of a command.
        place: full place of the command that begins.
        before: full place of the previous command. The further commands within a call don't reach the call
            again.
    """
    parts, there, last = wanted.upper().split(">"), place.upper().split(">"), before.upper().split(">")
    if not parts[0]:
        return there != last and len(there) > 1 and there[-1].partition("(")[0] == parts[1]
    size = len(parts)
    if len(there) < size or (there[:size] == last[:size]):
        return False
    return all(one in (two, two.partition("(")[0]) for one, two in zip(parts, there, strict=False))


def _change(table: InputTable, path: Path, known: Known, file: TomlFile) -> Change | None:
    assert table.input is not None and table.to is not None  # noqa: PT018  (of one entry)
    good = True
    variable = input_variable(table.input, known)
    if isinstance(variable, Diagnostic):
        file.say(variable.code, (*path, "input"), variable.message, variable.help, variable.subject)
        good = False
    given = [key for key in ("at", "place", "output") if getattr(table, key) is not None]
    if len(given) != 1:
        message = (
            f"The change of {table.input[:40]} has {' and '.join(given) or 'none of at, place and output'}."
        )
        at = (*path, given[1]) if given else path
        file.say("Y1618", at, message, "Say when it happens by one of at, place and output.", at_key=True)
        good = False
    if table.toggle is not None and len(table.toggle) != 2:
        message = f"toggle has {len(table.toggle)} times, not 2."
        file.say("Y1618", (*path, "toggle"), message, "Write toggle = [1.0, 2.0]: how long so, how long not.")
        good = False
    if isinstance(variable, str) and (
        fault := _group_fault(table.input[:40], variable, table.to, toggles=table.toggle is not None)
    ):
        file.say("Y1618", (*path, "input"), fault, "Check the number, or name a bit, as JOB.0.")
        good = False
    output = None if table.output is None else _output(table.output, (*path, "output"), known, file)
    good &= table.output is None or output is not None
    place = None if table.place is None else _place(table.place, (*path, "place"), known, file)
    good &= table.place is None or place is not None
    if not good or not isinstance(variable, str) or table.to is None:
        return None
    toggle = None if table.toggle is None else (table.toggle[0], table.toggle[1])
    return Change(variable, table.to, table.at, place, output, table.delay, toggle, bool(table.stuck))


def _output(text: str, path: Path, known: Known, file: TomlFile) -> tuple[str, float] | None:
    name, equals, value = text.partition("=")
    name, number = name.strip().upper(), value_of(value)
    if not equals or number is None:
        message = f'output is "{text[:40]}", but must be a name and a value.'
        file.say("Y1308", path, message, 'Write it as output = "CLAMP=ON".')
        return None
    variable = known.outputs.get(name) or known.signal(name).name
    if variable is None:
        file.say("Y1617", path, f"No output is named {name[:40]}.", *did_you_mean(name, known.outputs))
        return None
    return variable, number


def _place(place: str, path: Path, known: Known, file: TomlFile) -> str | None:
    """Return the name of a command in the form that `is_reached` requires; None, with a finding, if the
    program has no command that a script calls so.
    """
    if not known.has_places:
        message = f"The place {place[:40]} is of a program, which a controller doesn't know."
        file.say("Y1617", path, message, "Use at or output, or `yarc run --inputs`.")
        return None
    if known.places is None or any(is_reached(place, one) for one in known.places):
        return place
    # The index may be that of a command that is only in a SUB.
    in_subs = f">{place.strip()}"
    if ">" not in place and any(is_reached(in_subs, one) for one in known.places):
        return in_subs
    if any(is_reached(one, each) for one in (place, in_subs) for each in known.unseen):
        message = f"A run doesn't report when the command {place[:40].strip()} begins."
        help_ = 'Name a motion, a WAIT for an input or a HOLD, or an output: output = "CLAMP=ON".'
        file.say("Y1618", path, message, help_)
        return None
    indices = {part for one in known.places for part in [one.partition("(")[0].partition(">")[0]]}
    shown = place[:40].strip()
    near = did_you_mean(re.split(r"[(>]", shown.upper())[0], indices)
    file.say("Y1617", path, f"The program has no command {shown}.", *near)
    return None


def _spelled_out(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data of a script with ON and OFF replaced by numbers."""
    entries: Iterable[Any] = data.get("inputs", ()) if isinstance(data.get("inputs"), list) else ()
    for entry in entries:
        state = entry.get("to") if isinstance(entry, dict) else None
        if isinstance(state, str) and state.upper() in _STATES:
            entry["to"] = _STATES[state.upper()]
    return data
