"""Programs in files: loading, running, saving."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from yarclang.coordinator.programs import Loaded, load_program, way_to_start
from yarclang.diagnostics import Result
from yarclang.repl.dot import DotCommand, Misused
from yarclang.repl.file import load_file, open_file
from yarclang.repl.interpreter import Interpreter

_ENDING = ".yarc"


async def _load(interpreter: Interpreter, rest: str) -> None:
    if not rest:
        raise Misused("a file is missing")
    path, coordinator = interpreter.folder / rest, interpreter.coordinator
    loaded = load_file(path, coordinator.robot, await coordinator.stands(), coordinator.planner.cell)
    interpreter.show(loaded.diagnostics)
    if loaded.value is None:
        return
    adopted = await interpreter.client.adopt(loaded.value.declarations)
    interpreter.show(adopted.diagnostics)
    if adopted.value is None:
        return
    interpreter.file = loaded.value
    commands, declarations = loaded.value.commands, len(loaded.value.declarations)
    which = f"{len(commands)} commands, {commands[0]} to {commands[-1]}" if commands else "no commands"
    interpreter.say(
        f"{path}: {which}; its {declarations} declarations hold here from now on; .run carries it out"
    )


async def _run(interpreter: Interpreter, rest: str) -> None:
    await _carry_out(interpreter, rest, by_steps=False)


async def _step(interpreter: Interpreter, rest: str) -> None:
    await _carry_out(interpreter, rest, by_steps=True)


async def _carry_out(interpreter: Interpreter, first: str, *, by_steps: bool) -> None:
    """Compile the file as it is now, show the whole, ask, run."""
    file = interpreter.file
    if file is None:
        interpreter.refuse("no program is loaded: .load FILE")
        return
    coordinator = interpreter.coordinator
    here = await coordinator.stands()

    def compiled() -> Result[Loaded]:
        opened = open_file(file.path, coordinator.robot, here, coordinator.planner.cell)
        if opened.value is None:
            return Result(None, opened.diagnostics)
        made = load_program(opened.value, file.path.name, first.upper() or None, by_steps=by_steps)
        return Result(made.value, (*opened.diagnostics, *made.diagnostics))

    made: Result[Loaded] = await coordinator.plan(compiled)
    interpreter.show(made.diagnostics)
    loaded = made.value
    if loaded is None:
        return
    interpreter.plan = loaded.plan
    count, duration = len(loaded.rest.commands), loaded.rest.duration
    interpreter.say(
        f"{loaded.name}: {count} motion{'s' * (count != 1)}, {duration:.2f} s"
        + (", one by one" if by_steps else "")
    )
    way = way_to_start(coordinator.robot, loaded, here)
    interpreter.show(way.findings)
    if way.text:
        interpreter.say(way.text)
        if way.job is None or not await interpreter.agrees(
            f"approach it slowly first, {way.job.duration:.1f} s?"
        ):
            interpreter.refuse("nothing moved")
            return
    elif interpreter.asks and not await interpreter.agrees("go?"):
        interpreter.say("nothing moved")
        return
    if by_steps:
        interpreter.say("Enter goes on to the next one")
    interpreter.over(await interpreter.client.run(loaded, approach=bool(way.text)))


def _save(interpreter: Interpreter, rest: str) -> None:
    if not rest:
        raise Misused("a file is missing")
    path = interpreter.folder / rest
    if path.suffix != _ENDING:
        raise Misused(f"{path.name} must end with {_ENDING}")
    if path.exists():
        raise Misused(f"{path} is there already")
    interpreter.client.save(path)
    interpreter.say(f"{path} does what this session did")


def _files(interpreter: Interpreter, begun: str) -> Iterator[str]:
    """Programs and folders whose names begin so."""
    inside = begun.rpartition("/")[0]
    folder = interpreter.folder / inside if inside else interpreter.folder
    if not folder.is_dir():
        return
    for one in sorted(folder.iterdir()):
        name = str(Path(inside) / one.name)
        if name.startswith(begun) and (one.is_dir() or one.suffix == _ENDING):
            yield f"{name}/" if one.is_dir() else name


def _indices(interpreter: Interpreter, begun: str) -> Iterator[str]:
    """Indices of the loaded program that begin so."""
    commands = interpreter.file.commands if interpreter.file else ()
    return (one for one in commands if one.startswith(begun.upper()))


COMMANDS = (
    DotCommand(
        ".load",
        "FILE",
        "read a program; its declarations hold from now on",
        "programs",
        _load,
        complete=_files,
    ),
    DotCommand(
        ".run", "[P0010]", "run the loaded program, or from a command on", "programs", _run, complete=_indices
    ),
    DotCommand(".step", "[P0010]", "run it command by command", "programs", _step, complete=_indices),
    DotCommand(".save", "FILE", "write this session as a program", "programs", _save),
)
