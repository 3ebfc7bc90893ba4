"""One PLC program and its scans (TSRM 39-42)."""

from __future__ import annotations

import re

from yarclang.simulator.language.arithmetic import value_of
from yarclang.simulator.language.statements import Address, Assign, Plcs, Say, Skipped
from yarclang.simulator.network.reply import Refusal
from yarclang.simulator.programs.program import Branch, Go, Program
from yarclang.simulator.programs.surroundings import Surroundings
from yarclang.simulator.state.registers import Seen, Variables

_AT_ONCE = 5000
"""Largest number of statements in one scan of a PLC. The simulator ends the scan then; on a real controller,
the watchdog would trip.
"""

_VARIABLE = re.compile(r"([IPQM])(\d+)")
_INDIRECT = re.compile(r"[IPQM]\(")


class Plc:
    """One PLC program and its state.

    Attributes:
        number: 0 to 31.
        program: the statements of the PLC.
        enabled: True after ENABLE.
        paused: True after PAUSE.
        motor: number of the motor that the PLC's commands address.
        system: number of the coordinate system that the PLC's commands address.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.program = Program()
        self.enabled = False
        self.paused = False
        self.motor = 1
        self.system = 1
        self._at = 0

    @property
    def active(self) -> bool:
        """True if the PLC is scanned."""
        return self.enabled and not self.paused and bool(self.program.lines)

    def enable(self) -> None:
        """Enable the PLC, from the top of its program."""
        self.enabled, self.paused, self._at = True, False, 0

    def disable(self) -> None:
        """Disable the PLC, so that it isn't scanned any more."""
        self.enabled = self.paused = False

    def results(self) -> frozenset[tuple[str, int]]:
        """Return the variables that the PLC assigns, if it only computes variables; empty for any other PLC.

        A PLC that only computes variables consists of assignments to P- and Q-variables that it doesn't read
        itself. It therefore needn't be scanned before one of these variables is read.
        """
        targets: list[tuple[str, int]] = []
        mentioned: list[tuple[str, int]] = []
        for line in self.program.lines:
            if _INDIRECT.search(line.text):
                return frozenset()
            mentioned += [(letter, int(index)) for letter, index in _VARIABLE.findall(line.text)]
            for statement in line.statements:
                if (
                    not isinstance(statement, Assign)
                    or statement.letter not in "PQ"
                    or callable(statement.index)
                    or statement.last is not None
                ):
                    return frozenset()
                targets.append((statement.letter, int(statement.index)))
        if len(set(targets)) < len(targets) or any(mentioned.count(target) > 1 for target in targets):
            return frozenset()
        return frozenset(targets)

    def scan(self, variables: Variables, outside: Surroundings) -> None:
        """Scan the PLC once, up to the end of its program or the end of a loop. The next scan continues from
        there.

        An error disables the PLC (assumed), such as a wrong structure of the program or a variable that
        doesn't exist.
        """
        try:
            self._scan(variables, outside)
        except Refusal:
            self.disable()

    def _scan(self, variables: Variables, outside: Surroundings) -> None:
        code, _, _ = self.program.code()
        scope = variables.scope(self.system)
        at = self._at
        self._at = 0
        for _ in range(_AT_ONCE):
            if at >= len(code):
                return
            item = code[at]
            at += 1
            match item:
                case Assign():
                    self._assign(item, scope)
                case Branch(condition=condition, target=target, wait=wait):
                    if not condition(scope):
                        at = target
                    elif wait:
                        self._at = at - 1
                        return
                case Go(target=target, back=back):
                    at = target
                    if back:
                        self._at = at
                        return
                case Say(name="CMD", text=text):
                    outside.queue(text, self.system, self.motor)
                case Say(name="SEND", text=text):
                    outside.say(text)
                case Plcs(name=name, numbers=numbers):
                    outside.switch_plcs(name, numbers)
                    if not self.active:
                        return
                case Address(motor=motor, system=system):
                    self.motor, self.system = motor or self.motor, system or self.system
                    scope = variables.scope(self.system)
                case Skipped(name=name):
                    outside.unknown(name)
                case _:
                    pass

    def _assign(self, assign: Assign, scope: Seen) -> None:
        first = int(value_of(assign.index, scope))
        value = value_of(assign.value, scope)
        for index in range(first, (assign.last if assign.last is not None else first) + 1):
            scope.write(assign.letter, index, value)
