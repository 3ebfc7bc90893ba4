"""Count the convex pieces of the bodies whose meshes are divided into several (`pieces = N`)."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.cell.model import Cell
from yarclang.collision.geometry import UnreadableError
from yarclang.collision.scene import geometries
from yarclang.frozen import frozen
from yarclang.handling.present import around_start
from yarclang.robot.model import Robot
from yarclang.shapes import Mesh, Shape


@frozen
class Divided:
    """A body whose mesh is divided into convex pieces.

    Attributes:
        name: name of the body. Several parts of one kind are one entry, whose name has no number.
        count: number of its pieces.
        most: largest number of pieces that the description allows.
    """

    name: str
    count: int
    most: int

    @property
    def words(self) -> str:
        """The number of pieces in words."""
        pieces = f"{self.count} convex piece{'s' * (self.count != 1)}"
        return f"{self.name} is represented by {pieces}, of at most {self.most}"


def divided_bodies(robot: Robot, cell: Cell | None) -> tuple[Divided, ...]:
    """Return the bodies of a robot and its cell whose meshes are divided into convex pieces, in the order of
    their files. Meshes that can't be read are left out.
    """
    counts: dict[str, list[int]] = {}
    for name, shape, is_hull in _shapes(robot, cell):
        if isinstance(shape, Mesh) and shape.pieces:
            made = geometries(shape, is_hull)
            if not isinstance(made, UnreadableError):
                found = counts.setdefault(name, [0, 0])
                found[0] += len(made)
                found[1] += shape.pieces
    return tuple(Divided(name, count, most) for name, (count, most) in counts.items())


def _shapes(robot: Robot, cell: Cell | None) -> Iterator[tuple[str, Shape, bool]]:
    """Yield for each body its name, its shape, and True if its mesh counts as one convex hull unless `pieces`
    is given.
    """
    for link in robot.shapes:
        yield link.link, link.shape, True
    for tool in robot.tools:
        for part in tool.shapes if tool.mounted else ():
            yield tool.name, part.shape, True
    around, seen = around_start(cell), set()
    for body in () if around is None else around.obstacles:
        name = body.name.partition(" ")[0] if body.is_part else body.name
        if name not in seen:  # the parts of a kind have one shape
            seen.add(name)
            yield name, body.shape, False
