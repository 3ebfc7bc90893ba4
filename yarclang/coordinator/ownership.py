"""Who may move the robot: one at a time, all others watch. No I/O."""

from __future__ import annotations

from yarclang.runtime.actions import Trouble


class NotOwner(Trouble):
    """Somebody who doesn't own the robot wants to move it."""

    def __init__(self, what: str, remedy: str) -> None:
        super().__init__(what, remedy, code="Y1611")


class Ownership:
    """Who owns the robot, by their names.

    Attributes:
        owner: the name; empty where nobody does.
        shared: whether others may resume and change the pace as well.
    """

    def __init__(self) -> None:
        self.owner = ""
        self.shared = False

    def take(self, name: str, *, shared: bool = False) -> bool:
        """Own it from now on; whether that is new.

        Raises:
            NotOwner: somebody else does.
        """
        if self.owner == name:
            self.shared = shared
            return False
        if self.owner:
            raise NotOwner(
                f"{self.owner} owns the robot; {name} can only watch",
                f"wait until {self.owner} releases it or gives it to {name}; stop, hold and abort are for everybody",
            )
        self.owner, self.shared = name, shared
        return True

    def check(self, name: str, what: str) -> None:
        """Whether somebody may do what is for the owner.

        Raises:
            NotOwner: no.
        """
        if self.owner == name:
            return
        who = f"{self.owner} owns the robot" if self.owner else "nobody owns the robot"
        remedy = f"wait until {self.owner} releases it" if self.owner else "own it first"
        raise NotOwner(f"{what} is for the robot's owner: {who}, {name} watches", remedy)

    def check_pace(self, name: str, what: str) -> None:
        """Check whether somebody may resume, and change the pace: the owner, and others where the owner shares that.

        Raises:
            NotOwner: no.
        """
        if not (self.owner and self.shared):
            self.check(name, what)

    def give(self, name: str, to: str, known: tuple[str, ...]) -> None:
        """Give it over.

        Args:
            name: who gives; the owner.
            to: who owns it then; empty: nobody.
            known: who there is.

        Raises:
            NotOwner: it isn't theirs to give, or there is no such client.
        """
        self.check(name, "to give the robot over")
        if to and to not in known:
            others = ", ".join(one for one in known if one != name) or "nobody else"
            raise NotOwner(f"there is no client {to!r} to own the robot", f"there is {others}")
        self.owner, self.shared = to, False
