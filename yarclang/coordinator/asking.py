"""What a client of a coordinator may ask, and what it may set: where the robot stands, inputs and outputs, the session as a program."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from yarclang.diagnostics import Result, has_errors
from yarclang.hir import LineMove, PoseGoal, Program, SetOutput, WaitInput
from yarclang.pipeline.stages import check_program
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Script, Trouble
from yarclang.syntax.parse import parse

if TYPE_CHECKING:
    from yarclang.coordinator.coordinator import Coordinator


@dataclass(frozen=True, slots=True, eq=False)
class Where:
    """Where the robot stands: `joints` (n,) commanded [rad or m], and `base_from_moving` (4, 4), the moving frame in the frame that was asked for."""

    joints: Array
    base_from_moving: Array


class Asking:
    """What every client may ask. Names are looked up behind the session's lines, by the stages that always look them up.

    Attributes:
        name: what others know the client by.
    """

    def __init__(self, coordinator: Coordinator, name: str) -> None:
        self.name = name
        self._coordinator = coordinator

    @property
    def robot(self) -> Robot:
        """The robot that the coordinator owns."""
        return self._coordinator.robot

    async def stands(self) -> Array:
        """(n,) where the robot is commanded to stand [rad or m], asked now.

        Raises:
            Trouble: the robot is under way, or there is no connection.
        """
        return await self._coordinator.stands()

    async def frame(self, moving: str) -> Result[Array]:
        """Where a frame that motions may move sits on the flange: (4, 4) flange_from_moving."""
        step = self._step_of(f"MOVEL {moving} 0 0 0 0 0 0 [1] (mm,deg,s) {{B}}")
        if step.value is None:
            return Result(None, step.diagnostics)
        assert isinstance(step.value, LineMove)
        return Result(step.value.goal.flange_from_moving, step.diagnostics)

    async def where(self, base: str = "{B}", moving: str = "{TCP}") -> Result[Where]:
        """Where the robot stands, as joints and as the pose of a frame in another.

        Args:
            base: the frame in which the pose is told; any that a motion may name as its base.
            moving: the frame whose pose it is; any that a motion may move.

        Raises:
            Trouble: the robot is under way, or there is no connection.
        """
        coordinator = self._coordinator
        step = self._step_of(f"MOVEL {moving} 0 0 0 0 0 0 [1] (mm,deg,s) {base}")
        if step.value is None:
            return Result(None, step.diagnostics)
        assert isinstance(step.value, LineMove)
        goal = step.value.goal
        assert isinstance(goal, PoseGoal)
        joints = await coordinator.stands()
        pose = tool_poses(coordinator.robot.chain, joints[None], goal.flange_from_moving)[0]
        return Result(Where(joints, np.linalg.inv(goal.base_from_moving) @ pose))

    async def read(self, name: str) -> Result[float]:
        """The value of an input or output that the session declares.

        Raises:
            Trouble: the robot is under way, or there is no connection.
        """
        step = self._step_of(f"WAIT {name} ON [1] (s)")
        if step.value is None:
            output = self._step_of(f"SET {name} 1")
            step = step if output.value is None else output
        if step.value is None:
            return Result(None, step.diagnostics)
        made = step.value
        assert isinstance(made, WaitInput | SetOutput)
        signal = made.input if isinstance(made, WaitInput) else made.output
        return Result(await self._ask_number(signal.variable))

    async def set(self, name: str, value: float | str) -> Result[float]:
        """Give an output that the session declares a value, at once: a number, `ON` or `OFF`.

        Returns:
            What the controller says that it is then.

        Raises:
            NotOwner: this client only watches.
            Trouble: the robot is under way (then outputs are the program's), or there is no connection.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self.name, "to set an output")
        given = value if isinstance(value, str) else f"{value:g}"
        step = self._step_of(f"SET {name} {given}")
        if step.value is None:
            return Result(None, step.diagnostics)
        made = step.value
        assert isinstance(made, SetOutput)
        operation = coordinator.engine.operation
        line = f"{made.output.variable}={made.value:.9g}"
        await coordinator.engine.ask(lambda: operation.ask(line))
        return Result(await self._ask_number(made.output.variable))

    def saved(self) -> str:
        """The session as a program that does the same."""
        coordinator = self._coordinator
        return coordinator.history.saved(coordinator.lines)

    def save(self, path: Path) -> None:
        """Write the session as a program.

        Raises:
            Trouble: the file can't be written, and why.
        """
        try:
            path.write_text(self.saved(), encoding="utf-8")
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise Trouble(f"{path} can't be written: {reason}", "choose another place") from None

    async def _ask_number(self, variable: str) -> float:
        operation = self._coordinator.engine.operation

        def asked() -> Script[tuple[float, ...]]:
            return operation.numbers(variable, 1)

        (value,) = await self._coordinator.engine.ask(asked)
        return value

    def _step_of(self, text: str) -> Result[object]:
        """What a command means behind the session's lines: names are looked up where they always are."""
        checked = self._checked(text)
        return Result(checked.value.steps[-1] if checked.value else None, checked.diagnostics)

    def _checked(self, text: str) -> Result[Program]:
        """A command behind the session's lines, checked; None where it has errors."""
        coordinator = self._coordinator
        typed = coordinator.lines.behind(text)
        parsed = parse(typed.source)
        assert parsed.value is not None  # parsing always gives a tree
        checked = check_program(parsed.value, coordinator.planner.request(coordinator.robot.home))
        found = typed.placed((*parsed.diagnostics, *checked.diagnostics))
        if checked.value is None or has_errors(found):
            return Result(None, found)
        return Result(checked.value, found)
