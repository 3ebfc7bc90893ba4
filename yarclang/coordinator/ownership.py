"""The right to move the robot: only one client has it at a time, all others watch. No I/O."""

from __future__ import annotations

from yarclang.runtime.actions import Trouble


class NotOwner(Trouble):
    """Raised if a client that doesn't own the robot tries to move it."""

    def __init__(self, action: str, remedy: str) -> None:
        super().__init__(action, remedy, code="Y1611")


class Ownership:
    """The owner of the robot, by name.

    Attributes:
        owner: name of the owner; empty if there is none.
        shared: True if other clients may resume and change the override as well.
    """

    def __init__(self) -> None:
        self.owner = ""
        self.shared = False

    def take(self, name: str, *, shared: bool = False) -> bool:
        """Make a client the owner of the robot. Return True if the owner has changed.

        Raises:
            NotOwner: another client owns the robot.
        """
        if self.owner == name:
            self.shared = shared
            return False
        if self.owner:
            raise NotOwner(
                f"{self.owner} owns the robot; {name} can only watch",
                f"wait until {self.owner} releases it or gives it to {name}; stop, hold and abort are "
                f"for everybody",
            )
        self.owner, self.shared = name, shared
        return True

    def check(self, name: str, action: str) -> None:
        """Check that a client may give an order that only the owner may give.

        Raises:
            NotOwner: the client doesn't own the robot.
        """
        if self.owner == name:
            return
        who = f"{self.owner} owns the robot" if self.owner else "nobody owns the robot"
        remedy = f"wait until {self.owner} releases it" if self.owner else "own it first"
        raise NotOwner(f"{action} is for the robot's owner: {who}, {name} watches", remedy)

    def check_pace(self, name: str, action: str) -> None:
        """Check that a client may resume and change the override. The owner may, and if the owner shares the
        robot, all others may as well.

        Raises:
            NotOwner: the client isn't allowed to.
        """
        if not (self.owner and self.shared):
            self.check(name, action)

    def give(self, name: str, to: str, clients: tuple[str, ...]) -> None:
        """Hand the robot over.

        Args:
            name: current owner.
            to: new owner; empty for nobody.
            clients: names of all clients.

        Raises:
            NotOwner: `name` doesn't own the robot, or there is no client `to`.
        """
        self.check(name, "to give the robot over")
        if to and to not in clients:
            others = ", ".join(one for one in clients if one != name) or "nobody else"
            raise NotOwner(f"there is no client {to!r} to own the robot", f"there is {others}")
        self.owner, self.shared = to, False
