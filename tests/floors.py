"""Floors of tests that draw their cases by chance: the share of the cases that must really be exercised.

A test that may leave a case early passes with an empty run if all cases are left early. Such a test counts
its cases, and its floor fails the run.

A share of few cases is below its floor by chance now and then. Then more are drawn, and all of them together
are held to the floor.
"""

import functools
import inspect
from collections import Counter


class Tally:
    """Counts of drawn cases by what they are, and of the cases among them that were exercised."""

    def __init__(self):
        self.drawn, self.reached = Counter(), Counter()

    def count(self, what, reached=True):
        """Count one case of a name; `reached` says whether it was exercised."""
        self.drawn[what] += 1
        self.reached[what] += bool(reached)

    def below(self, floors):
        """Return a sentence for each name whose share of exercised cases is below its floor, or of which no
        case was drawn.

        Args:
            floors: the least share by name; at least one case must be exercised in any case.
        """
        return [
            (
                f"{what}: {self.reached[what]} of {self.drawn[what]} cases exercised, at least {least:.0%} "
                "expected"
            )
            for what, least in floors.items()
            if self.reached[what] < max(1.0, least * self.drawn[what])
        ]


ROUNDS = 8
"""A test whose shares are below their floors draws its cases at most so many times."""


def exercises(**floors):
    """Decorate a test that runs many drawn cases: the test gets a `tally`, and fails if a share is below its
    floor in all rounds together.

    The decorator stands above `given`, and `tally` is the first parameter of the test.
    """

    def decorate(test):
        @functools.wraps(test)
        def held(*args, **kwargs):
            tally = Tally()
            for _ in range(ROUNDS):
                test(*args, tally=tally, **kwargs)
                if not (short := tally.below(floors)):
                    return
            raise AssertionError("; ".join(short))

        signature = inspect.signature(test)
        rest = [one for name, one in signature.parameters.items() if name != "tally"]
        held.__signature__ = signature.replace(parameters=rest)
        return held

    return decorate
