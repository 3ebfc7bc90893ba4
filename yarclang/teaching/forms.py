"""Forms with which a user fills in a new command, and the program lines that result from them.

The forms are built from the descriptions of the commands and from the documentation of the modules.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from yarclang.cell.tools import NO_TOOL
from yarclang.commands.registry import actions, commands
from yarclang.commands.spec import ActionSpec, CommandSpec, Values
from yarclang.consulted import modules_in
from yarclang.decisions import Register
from yarclang.hir import Output
from yarclang.pipeline.modules import library_folder
from yarclang.report.module_text import ModuleText, ParameterText, SubText, describe_module
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.semantics.names.scope import Input, JointPosition, Pose, RackTool
from yarclang.syntax.ast import Module
from yarclang.teaching.declaring import check_name, place_of_declarations, units_part
from yarclang.teaching.edits import Draft, Edited
from yarclang.teaching.fields import STATES_OF_SIGNALS, Field, fields_of
from yarclang.teaching.holding import Around, Holding, holding
from yarclang.teaching.lines import insert
from yarclang.teaching.wording import checked
from yarclang.units import Kind
from yarclang.words.spec import Slot

COMMENT = "!"
_MOST_MODULES = 200


@dataclass(frozen=True, slots=True)
class Form:
    """A form for a new command.

    Attributes:
        command: name of the command; `CALL PICKPLACE.PICK` for a CALL of a SUB; "!" for a comment.
        label: name that is displayed.
        summary: what the command does.
        fields: fields to fill in, with proposed values.
    """

    command: str
    label: str
    summary: str
    fields: tuple[Field, ...]


@dataclass(frozen=True, slots=True)
class Known:
    """Names of a program that a user may choose in a form.

    Attributes:
        inputs: names of inputs.
        outputs: names of outputs.
        frames: names of fixed frames, without braces.
        tools: names of frames that the robot moves, without braces.
        joints: names of joint positions.
        poses: names of poses.
        registers: names of registers.
        subs: documentation of SUBs by module name; "" is the program itself.
        tools_of_cell: names of the tools in the cell's tool rack.
    """

    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    frames: tuple[str, ...] = ()
    tools: tuple[str, ...] = ()
    joints: tuple[str, ...] = ()
    poses: tuple[str, ...] = ()
    registers: tuple[str, ...] = ()
    subs: Mapping[str, ModuleText] | None = None
    tools_of_cell: tuple[str, ...] = ()


def known(around: Around) -> Known:
    """Return the names that a program, its cell and its modules declare."""
    scope, folder = around.scope, around.program
    frames = {name: scope.frame(name) for name in scope.frame_names()}
    texts = {"": describe_module(folder.sketch.module)}
    load = around.request.load
    used = {one.name for one in folder.sketch.names.symbols if one.kind == "module"}
    names = dict.fromkeys([*sorted(used), *(path.stem.upper() for path in modules_in(library_folder()))])
    for name in list(names)[:_MOST_MODULES]:
        module: Module | None = load(name).value if load is not None else None
        if module is not None:
            texts[name] = describe_module(module)
    return Known(
        tuple(scope.names(Input)),
        tuple(scope.names(Output)),
        tuple(name for name, one in frames.items() if one is not None and not one.on_flange),
        tuple(name for name, one in frames.items() if one is not None and one.on_flange),
        tuple(scope.names(JointPosition)),
        tuple(scope.names(Pose)),
        tuple(scope.names(Register)),
        texts,
        tuple(scope.names(RackTool)),
    )


def forms(names: Known, robot: Robot | None = None) -> tuple[Form, ...]:
    """Return the forms of all commands.

    Args:
        names: names that may be chosen.
        robot: the robot whose joints get fields; None for a robot with six joints.
    """
    joints = robot.joint_names if robot is not None else tuple(f"J{number}" for number in range(1, 7))
    return (
        *(_of_action(spec, names) for spec in actions().values()),
        *_of_others(),
        *(_of_motion(spec, names, joints) for spec in commands().values()),
        *_of_calls(names),
    )


def _of_action(spec: ActionSpec, names: Known) -> Form:
    slots, is_optional = spec.fullest.slots, _may_be_empty(spec)
    fields = []
    for slot, field in zip(slots, fields_of(slots), strict=True):
        known_ones = {
            Slot.INPUT: names.inputs,
            Slot.OUTPUT: names.outputs,
            Slot.REGISTER: ("", *names.registers),
            Slot.TOOL: (*names.tools_of_cell, NO_TOOL),
        }
        choices = known_ones.get(slot, field.choices)
        proposed = "look, then resume" if slot is Slot.TEXT else "" if is_optional else _first(choices)
        fields.append(replace(field, value=proposed, choices=choices))
    if spec.takes_time:
        fields.append(Field("time", "Time", "number", "1", "s"))
    return Form(spec.name, spec.title, spec.summary, tuple(fields))


def _may_be_empty(spec: ActionSpec) -> bool:
    return spec.form_of(0) is not None


def _of_others() -> Iterator[Form]:
    yield Form(COMMENT, "Comment", "a line for people", (Field("comment", "Comment", "text"),))
    name = Field("name", "Name", "signal")
    variable = Field("variable", "Variable of the controller, such as M1", "signal")
    safe = Field("safe", "Value at a stop (empty: unchanged)", "choice", "", choices=("", *STATES_OF_SIGNALS))
    yield Form("OUTPUT", "New output", "names an output of the controller", (name, variable, safe))
    yield Form("INPUT", "New input", "names an input of the controller", (name, variable))


def _of_motion(spec: CommandSpec, names: Known, joints: tuple[str, ...]) -> Form:
    fields: list[Field] = []
    values = spec.targets.get("")
    if values is not None:
        count = max(spec.waypoints[0], len(spec.leading) + 1)
        for number in range(1, count + 1):
            meaning = spec.leading[number - 1] if number <= len(spec.leading) else values
            front = f"{number}." if count > 1 else ""
            if meaning is Values.JOINTS:
                label = f"{front}target"
                choices = (*names.joints, *names.poses)
                fields.append(Field(label, f"{front}Target", "joints", "", choices=choices))
            elif not meaning.is_delta and meaning is not Values.POSITION:
                label = f"{front}target"
                fields.append(Field(label, f"{front}Target", "pose", "", choices=names.poses))
            fields += [
                Field(f"{front}{one}", f"{front}{one}", "number", "", _unit(meaning, one))
                for one in meaning.labels(joints)
            ]
    if spec.is_motion:
        fields.append(Field("time", "Time", "number", "", "s", () if spec.is_timed else ("MIN",)))
        if not spec.is_timed:
            fields.append(Field("percent", "Speed, share of the limits", "percent", "", "%"))
            fields.append(Field("ceiling", "Speed, at most", "number", "", "mm/s"))
    if spec.moves_frame:
        fields.append(Field("speed", "Speed", "number", "", "mm/s"))
        fields.append(Field("moving", "Moving frame", "frame", "", choices=names.tools))
        axes = (*names.frames, *names.tools) if spec.frames_may_move else names.frames
        fields.append(Field("base", "Base frame", "frame", "", choices=axes))
    return Form(spec.name, spec.name, spec.summary, tuple(fields))


def _unit(meaning: Values, label: str) -> str:
    return "" if meaning.of_joints else "mm" if label in ("x", "y", "z") else "deg"


def _of_calls(names: Known) -> Iterator[Form]:
    for module, text in (names.subs or {}).items():
        for sub in text.subs:
            called = f"{module}.{sub.name}" if module else sub.name
            yield Form(f"CALL {called}", called, sub.purpose, tuple(_parameters(sub, names)))


def _parameters(sub: SubText, names: Known) -> Iterator[Field]:
    given = sub.example.split()[2:]
    by_position = [one for one in given if "=" not in one]
    by_name = {one.partition("=")[0].upper(): one.partition("=")[2] for one in given if "=" in one}
    is_readable = len(given) <= len(sub.parameters) and "(" not in sub.example
    for at, one in enumerate(sub.parameters):
        value = by_position[at] if at < len(by_position) else by_name.get(one.word, one.default)
        yield _parameter(one, value if is_readable else one.default, names)


def _parameter(one: ParameterText, value: str, names: Known) -> Field:
    """Return the field for a parameter of a SUB. The words in the parameter's description decide which names
    the field proposes.
    """
    word, _, unit = one.name.partition(" (")
    label = f"{word}: {one.meaning}" if one.meaning else word
    if word.startswith("{"):
        is_tool = "tool" in one.meaning.lower() and "place" not in one.meaning.lower()
        choices = names.tools if is_tool else names.frames
        inner = word.strip("{}")
        shown = value.strip("{}").upper()
        return Field(inner, label, "frame", shown if shown in choices else _last(choices), choices=choices)
    if unit:
        return Field(word, label, "number", value, unit.rstrip(")"))
    meaning = one.meaning.lower()
    for begins, choices in (("input", names.inputs), ("output", names.outputs)):
        if meaning.startswith(begins):
            return Field(
                word, label, "signal", value if value in choices else _first(choices), choices=choices
            )
    if meaning.startswith("joint position"):
        return Field(word, label, "joints", _first(names.joints), choices=names.joints)
    return Field(word, label, "text", value)


def _first(names: tuple[str, ...]) -> str:
    return names[0] if names else ""


def _last(names: tuple[str, ...]) -> str:
    return names[-1] if names else ""


def put_in(around: Around, after: int, command: str, fields: Mapping[str, str]) -> Edited:
    """Insert a command into a program, with the values that the user has filled in.

    Args:
        around: the program.
        after: number of the line after which the command is inserted.
        command: name of the command's form.
        fields: filled-in texts by field name.

    Raises:
        Trouble: a value is missing or not allowed.
    """
    command = " ".join(command.split())
    if command.upper().startswith("CALL ") or command == COMMENT:
        form = next(
            (one for one in forms(known(around), around.robot) if one.command == command.upper()), None
        )
    else:
        form = next((one for one in forms(Known(), around.robot) if one.command == command.upper()), None)
    if form is None:
        raise Trouble(f"there is no form for {command[:60]!r}", "ask for the forms", "form")
    strangers = [name for name in fields if name not in {one.name for one in form.fields}]
    if strangers:
        known_ones = ", ".join(one.name for one in form.fields)
        raise Trouble(
            f"{form.command} has no field {strangers[0][:40]!r}", f"its fields are {known_ones}", "field"
        )
    given = {
        one.name: checked(one.name.rpartition(".")[2], one.kind, fields.get(one.name, ""))
        for one in form.fields
    }
    if form.command == COMMENT:
        return insert(around.program, after, f"! {given['comment']}".rstrip(), has_index=False)
    if form.command.startswith("CALL "):
        return _call(around, after, form, given)
    if form.command in ("OUTPUT", "INPUT"):
        return _declared(around, form, given)
    code = _code(around, after, form, given)
    return insert(around.program, after, code)


def _declared(around: Around, form: Form, given: Mapping[str, str]) -> Edited:
    _need(form, given, "name", "variable")
    name = check_name(around, given["name"], is_frame=False)
    line = " ".join(filter(None, (form.command, name, given["variable"].upper(), given.get("safe", ""))))
    draft = Draft(around.program)
    after = place_of_declarations(around.program, around.program.size + 1)
    draft.add(after, line)
    return draft.finished(draft.new_line(after) + len(draft.added[after]) - 1, f"declared {name}")


def _call(around: Around, after: int, form: Form, given: Mapping[str, str]) -> Edited:
    called = form.command.removeprefix("CALL ")
    missing = [one.label for one in form.fields if not given[one.name]]
    if missing:
        raise Trouble(f"{missing[0][:80]} is missing", "fill it in", "field")
    arguments = [f"{{{given[one.name]}}}" if one.kind == "frame" else given[one.name] for one in form.fields]
    module, dot, _ = called.partition(".")
    return insert(around.program, after, " ".join((form.command, *arguments)), use=module if dot else "")


def _code(around: Around, after: int, form: Form, given: Mapping[str, str]) -> str:
    """Return the line of a command other than CALL, without its index."""
    word = form.command
    holds = holding(around.program, after + 1)
    if (action := actions().get(word)) is not None:
        return _line_of_action(action, form, given, holds)
    spec = commands()[word]
    if not spec.targets:
        return word
    if spec.is_timed:
        _need(form, given, "time")
    values, needs_numbers = _waypoints(form, spec, given, around.robot)
    timed = [name for name in ("time", "percent", "speed", "ceiling") if given.get(name)]
    if len(timed) > 1:
        raise Trouble(
            f"{timed[0]} and {timed[1]} can't both be given in a line", "leave one of the two empty", "field"
        )
    written = {"time": "[{}]", "percent": "[{}%]", "speed": "[V {}]", "ceiling": "[V<={}]"}
    time = written[timed[0]].format(given[timed[0]]) if timed else "" if holds.time else "[50%]"
    kinds: list[Kind] = []
    of_joints = spec.targets[""].of_joints
    if needs_numbers:
        joint_kinds: list[Kind] = [
            "length" if one == "mm" else "angle" for one in around.robot.axis_unit_names
        ]
        kinds = joint_kinds if of_joints else ["length", "angle"]
    if timed and timed[0] != "percent" and given[timed[0]].upper() != "MIN":
        kinds.append("time")
        if timed[0] == "ceiling" and "length" not in kinds:
            kinds.insert(0, "length")
    units = units_part({kind: holds.unit(kind) for kind in kinds}, holds)
    named = (given[one.name] for one in form.fields if one.name.endswith("target") and given[one.name])
    goes_to_pose = any(isinstance(around.scope.name(name.upper()), Pose) for name in named)
    moving = given.get("moving") or ("" if holds.moving or (of_joints and not goes_to_pose) else around.tool)
    if not needs_numbers and given.get("base"):
        raise Trouble(
            "a named pose already has its base frame", "leave the base frame empty, or write numbers", "field"
        )
    base = given.get("base") or ("" if holds.base or of_joints or not needs_numbers else "B")
    frames = [f"{{{name}}}" if name else "" for name in (moving, base)]
    return " ".join(filter(None, (word, frames[0], values, time, *units, frames[1])))


def _line_of_action(spec: ActionSpec, form: Form, given: Mapping[str, str], holds: Holding) -> str:
    """Return the program line of an action (a command without motion), with the values that the user has
    filled in.

    All values are left out if the action doesn't require them, and the user has filled in nothing except a
    state (ON or OFF).
    """
    slots = spec.fullest.slots
    names = [one.name for one in fields_of(slots)]
    told = [given[name] for slot, name in zip(slots, names, strict=True) if slot is not Slot.STATE]
    if not any(told) and _may_be_empty(spec):
        slots, names = (), []
    values: list[str] = []
    for slot, name in zip(slots, names, strict=True):
        if slot is Slot.STATE and _may_be_empty(spec):
            values.append(given[name] or "ON")
        elif slot is Slot.REGISTER and not given[name]:
            slots = slots[:-1]  # the register is the last value, and is left out
        else:
            _need(form, given, name)
            values.append(f'"{given[name]}"' if slot is Slot.TEXT else given[name])
    chosen = spec.form_of(len(slots))
    assert chosen is not None
    if chosen.time == "must":
        _need(form, given, "time")
    if chosen.time and given["time"]:
        values += [f"[{given['time']}]", *units_part({"time": holds.unit("time")}, holds)]
    return " ".join((spec.name, *values))


def _waypoints(form: Form, spec: CommandSpec, given: Mapping[str, str], robot: Robot) -> tuple[str, bool]:
    """Return the waypoints as text, and True if they contain numbers."""
    count = max(spec.waypoints[0], len(spec.leading) + 1)
    points, has_numbers = [], False
    for number in range(1, count + 1):
        meaning = spec.leading[number - 1] if number <= len(spec.leading) else spec.targets[""]
        front = f"{number}." if count > 1 else ""
        if given.get(f"{front}target"):
            points.append(given[f"{front}target"])
            continue
        names = [f"{front}{one}" for one in meaning.labels(robot.joint_names)]
        _need(form, given, *names)
        points.append(" ".join(given[name] for name in names))
        has_numbers = True
    return "; ".join(points), has_numbers


def _need(form: Form, given: Mapping[str, str], *names: str) -> None:
    for name in names:
        if not given.get(name):
            label = next(one.label for one in form.fields if one.name == name)
            raise Trouble(f"{label[:80]} is missing", "fill it in", "field")
