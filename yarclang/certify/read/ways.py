"""The robot's position along the branches and loops of a text, as computed by the judge."""

from __future__ import annotations

from dataclasses import dataclass, field

from yarclang.robot.model import Array


@dataclass(slots=True)
class _Open:
    """A WHEN or a loop that has begun and not ended yet.

    Attributes:
        begins: True for a loop, False for a WHEN.
        before: (n,) position at its start.
        other: (n,) position at the end of a WHEN's first branch, or at a loop's first exit; None if not known
            yet.
        parted: True if the second branch of a WHEN has begun.
        over: True if the program does not reach the end of the first branch of a WHEN.
    """

    begins: bool
    before: Array
    other: Array | None = None
    parted: bool = False
    over: bool = False


@dataclass(slots=True)
class Standing:
    """The robot's current position while the actions of a text are followed one by one.

    Attributes:
        at: (n,) position.
        over: True if the program never reaches the current place of the text, for example after a STOP.
        open: the WHENs and loops that have not ended yet, outermost first.
    """

    at: Array
    over: bool = False
    open: list[_Open] = field(default_factory=list)

    def pass_(self, kind: str) -> tuple[Array, str] | None:
        """Follow the text past a barrier, and return the position that must equal the current one.

        Args:
            kind: kind of the barrier.

        Returns:
            The position that must equal the current one (`at`, which is then unchanged), and the fault to
            report if they differ. None if there is nothing to compare.

        Raises:
            ValueError: the barrier has no matching open WHEN or loop.
        """
        match kind:
            case "when" | "loop":
                self.open.append(_Open(kind == "loop", self.at))
            case "stop" | "abort":
                self.over = True
            case "else":
                top = self._top(loop=False, why="a second branch without a first")
                if top.parted:
                    raise ValueError("a second branch without a first")
                top.other, top.parted, top.over = self.at, True, self.over
                self.at, self.over = top.before, False
            case "end":
                return self._met(self._pop(loop=False, why="a branch ends that didn't begin"))
            case "next":
                loop, over, self.over = self._loop("begins anew"), self.over, True
                return None if over else (loop.before, "a pass ends elsewhere than where the loop begins")
            case "exit":
                loop, over, self.over = self._loop("is left"), self.over, True
                if over:
                    return None
                if loop.other is not None:
                    return loop.other, "the exits of a loop end at different positions"
                loop.other = self.at
            case "endloop":
                loop = self._pop(loop=True, why="a loop ends that didn't begin")
                if loop.other is None:
                    return None
                if self.over:
                    self.at, self.over = loop.other, False
                    return None
                return loop.other, "the exits of a loop end at different positions"
        return None

    def _met(self, when: _Open) -> tuple[Array, str] | None:
        position = when.before if when.other is None else when.other
        if when.over:
            return None
        if self.over:
            self.at, self.over = position, False
            return None
        return position, "branches that meet end at different positions"

    def _loop(self, what: str) -> _Open:
        loop = next((one for one in reversed(self.open) if one.begins), None)
        if loop is None:
            raise ValueError(f"a loop {what} that didn't begin")
        return loop

    def _top(self, *, loop: bool, why: str) -> _Open:
        if not self.open or self.open[-1].begins != loop:
            raise ValueError(why)
        return self.open[-1]

    def _pop(self, *, loop: bool, why: str) -> _Open:
        self._top(loop=loop, why=why)
        return self.open.pop()
