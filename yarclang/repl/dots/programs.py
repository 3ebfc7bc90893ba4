"""Load, run and save programs in files."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from yarclang.coordinator.attached import Here
from yarclang.coordinator.client.files import write_program
from yarclang.coordinator.describing import lasting_of
from yarclang.coordinator.lines import seen_from
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.findings import findings_of
from yarclang.repl.answers import hundredths
from yarclang.repl.declaring import adopt
from yarclang.repl.dot import DotCommand, Misused
from yarclang.repl.file import load_file
from yarclang.repl.session import Session

_ENDING = ".yarc"

_SAME = 1e-6
"""Two times count as equal if they differ by less than this [s]."""


async def _load(session: Session, rest: str) -> None:
    if not rest:
        raise Misused("a file is missing")
    path = session.folder / rest
    loaded = load_file(path, session.robot, await session.stands(), session.attached.welcome.status.cell)
    session.show(loaded.diagnostics)
    if loaded.value is None:
        return
    home, here = path.parent.absolute(), session.folder.absolute()
    declarations = tuple(seen_from(one, home, here) for one in loaded.value.declarations)
    if not await adopt(session, declarations):
        return
    session.file = loaded.value
    commands, count = loaded.value.commands, len(declarations)
    which = f"{len(commands)} commands, {commands[0]} to {commands[-1]}" if commands else "no commands"
    session.say(f"{path}: {which}; its {count} declarations are valid here from now on; .run carries it out")


async def _run(session: Session, rest: str) -> None:
    await _carry_out(session, rest, by_steps=False)


async def _step(session: Session, rest: str) -> None:
    await _carry_out(session, rest, by_steps=True)


async def _carry_out(session: Session, first: str, *, by_steps: bool) -> None:
    """Compile the loaded file, show its whole plan, ask, and run it."""
    file = session.file
    if file is None:
        session.refuse("no program is loaded: .load FILE")
        return
    robot = session.attached
    order = orders.Load(
        file=str(file.path.absolute()), first=first.upper() or None, by_steps=by_steps, here=True
    )
    made = await robot.ask(order)
    session.show(findings_of(made.findings))
    program = made.program
    if program is None:
        return
    if isinstance(robot, Here) and (loaded := robot.desk.loaded_of(program.number)) is not None:
        session.planned_by(lambda: loaded.plan)
    within = program.offset_s
    count = sum(one.begins_s >= within - _SAME for one in program.commands)
    session.say(
        f"{program.name}: {count} motion{'s' * (count != 1)}, "
        f"{lasting_of(program.rest_takes).text(hundredths)}" + (", one by one" if by_steps else "")
    )
    way = await robot.ask(orders.AskWay(program=program.number))
    session.show(findings_of(way.findings))
    if way.text:
        session.say(way.text)
        if way.duration_s is None or not await session.agrees(
            f"move slowly to its start first, {way.duration_s:.1f} s?"
        ):
            session.refuse("nothing moved")
            return
    elif session.asks and not await session.agrees("go?"):
        session.say("nothing moved")
        return
    await session.own()
    if by_steps:
        session.say("Enter goes on to the next one")
    ended = await robot.ask(orders.Run(program=program.number, approach=bool(way.text)))
    session.over(ended)


async def _save(session: Session, rest: str) -> None:
    if not rest:
        raise Misused("a file is missing")
    path = session.folder / rest
    if path.suffix != _ENDING:
        raise Misused(f"{path.name} must end with {_ENDING}")
    if path.exists():
        raise Misused(f"{path} already exists")
    saved = await session.attached.ask(orders.Save(folder=str(path.parent.absolute())))
    write_program(path, saved.text)
    session.say(f"{path} does what this session did")


def _files(session: Session, begun: str) -> Iterator[str]:
    """Yield programs and folders whose names begin with the typed text."""
    inside = begun.rpartition("/")[0]
    folder = session.folder / inside if inside else session.folder
    if not folder.is_dir():
        return
    for one in sorted(folder.iterdir()):
        name = str(Path(inside) / one.name)
        if name.startswith(begun) and (one.is_dir() or one.suffix == _ENDING):
            yield f"{name}/" if one.is_dir() else name


def _indices(session: Session, begun: str) -> Iterator[str]:
    """Yield indices of the loaded program that begin with the typed text."""
    commands = session.file.commands if session.file else ()
    return (one for one in commands if one.startswith(begun.upper()))


COMMANDS = (
    DotCommand(
        ".load",
        "FILE",
        "read a program; its declarations are valid from now on",
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
