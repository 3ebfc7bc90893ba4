"""Outputs of a program: their safe values at any stop, hold or fault, and the values that they get back when
the motion continues. No I/O.
"""

from __future__ import annotations

from yarclang.runtime.actions import Script
from yarclang.runtime.job import Job
from yarclang.runtime.pmac.operation import Operation


class Outputs:
    """The outputs for which a job has declared a safe value.

    The value of an output in the program is derived from the executed lines. The controller can't be asked
    for this value: after `secure`, the output has its safe value.
    """

    def __init__(self, job: Job) -> None:
        self._safe = dict(job.outputs)
        self._sets = job.sets
        self._before: dict[str, float] = {}
        self._secured = False

    def remember(self, operation: Operation) -> Script[None]:
        """Ask for the values of the outputs before the job. No buffer may be open on our port of the
        controller.
        """
        for variable in self._safe:
            (value,) = yield from operation.numbers(variable, 1)
            self._before[variable] = value

    def secure(self, operation: Operation) -> Script[None]:
        """Set all outputs to their safe values. No buffer may be open on our port of the controller."""
        self._secured = True
        for variable, value in self._safe.items():
            yield from operation.ask(f"{variable}={value:g}")

    def restore(self, operation: Operation, executed: int) -> Script[None]:
        """After `secure`, set all outputs to the values that they have after the first `executed` lines of
        the program.
        """
        if not self._secured:
            return
        values = dict(self._before)
        values |= {
            variable: value
            for row, variable, value in self._sets
            if row < executed and variable in self._safe
        }
        for variable, value in values.items():
            yield from operation.ask(f"{variable}={value:g}")
        self._secured = False
