"""Floors for tests with random cases: the least share of the cases that must be exercised.

A test that may leave a case early would pass with an empty run if it left all cases early. Such a test counts
its cases, and fails if a share is below its floor.

The share of a few cases may be below its floor by chance. Then more cases are drawn, and all of them together
must reach the floor.
"""

import functools
import inspect
from collections import Counter


class Tally:
    """Numbers of drawn cases by name, and of the cases among them that were exercised."""

    def __init__(self):
        self.drawn, self.reached = Counter(), Counter()

    def count(self, what, reached=True):
        """Count one case under a name; `reached` is true if it was exercised."""
        self.drawn[what] += 1
        self.reached[what] += bool(reached)

    def below(self, floors):
        """Return a sentence for each name whose share of exercised cases is below its floor, or that has no
        drawn case.

        Args:
            floors: the least share by name. For each name, at least one case must be exercised.
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
"""Most rounds of drawing cases in which a test may reach its floors."""


def exercises(**floors):
    """Decorate a test with many drawn cases: it gets a `tally`, and fails if a share over all its rounds is
    below its floor.

    The decorator stands above `given`, and `tally` is the test's first parameter.
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
