"""What SAVE keeps, and power-up: `$$$` with what was saved, `$$$***` with everything at its default."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from yarclang.simulator.motion.axes import AxisDefinition
from yarclang.simulator.programs.plc import Plc
from yarclang.simulator.programs.program import Program
from yarclang.simulator.state.registers import Definition

if TYPE_CHECKING:
    from yarclang.simulator.machine import Machine


@dataclass(frozen=True, slots=True)
class Saved:
    """What SAVE keeps: all but rotaries, positions and what runs."""

    i: list[float]
    p: list[float]
    q: list[dict[int, float]]
    m: dict[int, Definition]
    programs: dict[int, Program]
    plcs: dict[int, Program]
    definitions: dict[int, dict[int, AxisDefinition]]


def saved(machine: Machine) -> Saved:
    """What SAVE keeps now."""
    v = machine.variables
    return Saved(
        list(v.i),
        list(v.p),
        [dict(q) for q in v.q],
        dict(v.m),
        {number: program.copy() for number, program in machine.programs.items()},
        {number: plc.program.copy() for number, plc in machine.plcs.by_number.items()},
        {number: dict(system.definitions) for number, system in machine.systems.items()},
    )


def power_up(machine: Machine, kept: Saved | None) -> None:
    """Switch off and on, with what SAVE has kept or with defaults. Time goes on, ports keep nothing."""
    machine.variables.initialise()
    machine.programs.clear()
    machine.plcs.by_number.clear()
    machine.ports.clear()
    machine.background.clear()
    machine.timers.ends.clear()
    machine.gathering = False
    machine.under_way.clear()
    for motor in machine.motors.values():
        motor.clear()
    for system in machine.systems.values():
        system.clear()
    if kept is not None:
        _restore(machine, kept)
    machine.defined()
    machine.plcs.changed()
    machine.changed(list(machine.motors.values()))


def _restore(machine: Machine, kept: Saved) -> None:
    v = machine.variables
    v.i[:], v.p, v.q, v.m = kept.i, list(kept.p), [dict(q) for q in kept.q], dict(kept.m)
    machine.programs.update({number: program.copy() for number, program in kept.programs.items()})
    for number, program in kept.plcs.items():
        plc = machine.plcs.by_number[number] = Plc(number)
        plc.program = program.copy()
        plc.enable()
    for number, definitions in kept.definitions.items():
        for motor, definition in definitions.items():
            machine.systems[number].define(machine.motors[motor], definition)
