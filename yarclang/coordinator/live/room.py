"""Free room around a joint position: a box of joint positions in which all bodies stay apart. One proof of a
box is valid for all paths within it.

The text of a jog is proved every 30 ms, mostly with no obstacle nearby. As long as no obstacle is near, the
proof of one box replaces the proofs of many such texts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.collision.placing import box_gaps, distances, place, relative, sphere_gaps
from yarclang.collision.proof import SLACK
from yarclang.collision.scene import Scene
from yarclang.collision.travel import travel
from yarclang.robot.model import Array


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """A box of joint positions: each joint at most `reach` (n,) away from its position in `middle` (n,)
    [rad or m].
    """

    middle: Array
    reach: Array

    def has(self, lower: Array, upper: Array) -> bool:
        """Return True if another box of joint positions lies within this one.

        Args:
            lower: (n,) smallest joint positions of the other box [rad or m].
            upper: (n,) largest joint positions of the other box [rad or m].
        """
        inside = (lower >= self.middle - self.reach) & (upper <= self.middle + self.reach)
        return bool(inside.all())


def is_free(scene: Scene, room: Room) -> bool:
    """Return True if all pairs of bodies are proved to be farther apart than their margins plus `SLACK` at
    all joint positions in a room (a box of joint positions).

    A pair's distance is bounded from below by the distance at the middle of the room, minus the largest
    relative motion of the two bodies within the room (`collision.travel`). Bounding spheres decide most
    pairs, then bounding boxes, then the shapes themselves.
    """
    placed = place(scene, room.middle[None])
    moves = travel(placed, room.reach[None])
    needed = moves[scene.boxes.joint[scene.pairs.first], scene.pairs.second, 0] + scene.pairs.margin + SLACK
    pair = np.arange(len(needed))
    pair = pair[sphere_gaps(placed, np.zeros_like(pair), pair) < needed]
    seen = relative(placed, np.zeros_like(pair), pair)
    (left,) = np.nonzero(box_gaps(scene, pair, seen) < needed[pair])
    pair, seen = pair[left], seen.take(left)
    return bool((distances(scene, pair, seen, deep=False) >= needed[pair]).all())
