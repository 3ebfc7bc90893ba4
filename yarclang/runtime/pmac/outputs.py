"""Outputs of a program: their safe values at any stop, hold or fault, and what they were before."""

from __future__ import annotations

from yarclang.runtime.actions import Script
from yarclang.runtime.job import Job
from yarclang.runtime.pmac.operation import Operation


class Outputs:
    """The outputs that a job has declared with a safe value.

    What an output should be is known from the lines that were executed, not by asking: the controller's own guard may have made it
    safe already.
    """

    def __init__(self, job: Job) -> None:
        self._safe = dict(job.outputs)
        self._sets = job.sets
        self._before: dict[str, float] = {}
        self._secured = False

    def remember(self, operation: Operation) -> Script[None]:
        """Ask what they are before the job. No buffer may be open on this port."""
        for variable in self._safe:
            (value,) = yield from operation.numbers(variable, 1)
            self._before[variable] = value

    def secure(self, operation: Operation) -> Script[None]:
        """Give all of them their safe values. No buffer may be open on this port."""
        self._secured = True
        for variable, value in self._safe.items():
            yield from operation.ask(f"{variable}={value:g}")

    def restore(self, operation: Operation, executed: int) -> Script[None]:
        """Give them back what the program has made of them in its first `executed` lines."""
        if not self._secured:
            return
        meant = dict(self._before)
        meant |= {
            variable: value
            for row, variable, value in self._sets
            if row < executed and variable in self._safe
        }
        for variable, value in meant.items():
            yield from operation.ask(f"{variable}={value:g}")
        self._secured = False
