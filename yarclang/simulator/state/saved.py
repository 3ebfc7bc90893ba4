"""The state that SAVE keeps: everything except rotaries, positions and running programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from yarclang.simulator.motion.axes import AxisDefinition
from yarclang.simulator.motion.motors import Motor
from yarclang.simulator.motion.system import CoordinateSystem
from yarclang.simulator.programs.plc import Plc
from yarclang.simulator.programs.plcs import Plcs
from yarclang.simulator.programs.program import Program
from yarclang.simulator.state.registers import Definition, Variables


@dataclass(frozen=True, slots=True)
class Saved:
    """The state that SAVE copies, and that a reset restores.

    Attributes:
        i: I-variables.
        p: P-variables.
        q: Q-variables, by coordinate system.
        m: definitions of M-variables.
        programs: PROGs by number.
        plcs: programs of PLCs by number.
        definitions: axis definitions by coordinate system and motor.
    """

    i: list[float]
    p: list[float]
    q: list[dict[int, float]]
    m: dict[int, Definition]
    programs: dict[int, Program]
    plcs: dict[int, Program]
    definitions: dict[int, dict[int, AxisDefinition]]


def saved(
    variables: Variables, programs: Mapping[int, Program], plcs: Plcs, systems: Mapping[int, CoordinateSystem]
) -> Saved:
    """Return a copy of the state that SAVE keeps."""
    return Saved(
        list(variables.i),
        list(variables.p),
        [dict(q) for q in variables.q],
        dict(variables.m),
        {number: program.copy() for number, program in programs.items()},
        {number: plc.program.copy() for number, plc in plcs.by_number.items()},
        {number: dict(system.definitions) for number, system in systems.items()},
    )


def restore(
    saved: Saved,
    variables: Variables,
    programs: dict[int, Program],
    plcs: Plcs,
    systems: Mapping[int, CoordinateSystem],
    motors: Mapping[int, Motor],
) -> None:
    """Restore a saved state. All components of the machine must have been cleared before. The PLCs are
    enabled.
    """
    variables.i[:], variables.p = saved.i, list(saved.p)
    variables.q, variables.m = [dict(q) for q in saved.q], dict(saved.m)
    programs.update({number: program.copy() for number, program in saved.programs.items()})
    for number, program in saved.plcs.items():
        plc = plcs.by_number[number] = Plc(number)
        plc.program = program.copy()
        plc.enable()
    for number, definitions in saved.definitions.items():
        for motor, definition in definitions.items():
            systems[number].define(motors[motor], definition)
