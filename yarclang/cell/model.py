"""A cell as the stages see it: plain data in SI units, already checked, for one robot.

`yarclang.cell.description` makes it from a cell.toml. Arrays are float64 and read-only. Transforms are named so that
neighbours cancel: `base_from_x` maps coordinates of x to the robot's {B}, `flange_from_x` to its {FLANGE}.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.shapes import Box, Capsule, Cylinder, Shape, Sphere
from yarclang.source import SourceFile, Span

Array = NDArray[np.float64]
Rule = Literal["allowed", "forbidden", "slow", "posture"]

PARTS = ("tool", "tcp", "elbow", "arm")
"""What a zone may watch besides links by their names."""


@frozen(eq=False)
class Mount:
    """Where something sits: `transform` (4, 4) [m] is base_from_it, or, with `on_flange`, flange_from_it."""

    transform: Array
    on_flange: bool


@frozen(eq=False)
class CellFrame:
    """A frame of the cell: how it sits in its parent, `parent_from_frame` (4, 4) [m], and what that makes in all.

    `parent` is B, FLANGE, or the name of another frame of the cell.
    """

    name: str
    parent: str
    parent_from_frame: Array
    mount: Mount


@frozen
class CellOutput:
    """An output: the controller's variable, and its value at any stop, hold or fault (None: it stays as it is)."""

    variable: str
    safe: float | None


@frozen(eq=False)
class Obstacle:
    """A body that the robot must not touch, or, with a mount on the flange, a body that it carries.

    `margin` [m] is how far everything else stays away from it at least.
    """

    name: str
    shape: Shape
    mount: Mount
    margin: float


@frozen(eq=False)
class ShapeRegion:
    """The points in a shape that stands still, around the origin of `base_from_shape` (4, 4) [m]."""

    base_from_shape: Array
    shape: Box | Sphere | Cylinder | Capsule


@frozen(eq=False)
class HalfSpace:
    """The points p in {B} with normal . p >= offset: `normal` (3,) has the norm 1, `offset` is in m."""

    normal: Array
    offset: float


@frozen(eq=False)
class JointWindow:
    """The joint positions from `lower` (n,) to `upper` (n,) [rad or m]; infinite for joints that the window leaves open."""

    lower: Array
    upper: Array


Region = ShapeRegion | HalfSpace | JointWindow


@frozen(eq=False)
class Zone:
    """A region with a rule for what it watches.

    `allowed`: to stay inside; `forbidden`: to stay outside; `slow`: inside, no faster than `speed` [m/s]; `posture`: while it reaches inside,
    the joints stay in the window `posture`. `speed` and `posture` are None for the other rules.

    `watch` names what is watched, each of `PARTS` or a link of the URDF: `tcp` is the origin of the frame that a command moves, `tool` that and all
    bodies that the robot carries, `elbow` a point (`yarclang.robot.kinematics.elbow`), `arm` all links that the joints move. All of it stays `margin` [m]
    away from the border of a zone to stay in or out of, and the others begin so far before their border. A joint window that is allowed or forbidden watches
    nothing but the joints.
    """

    name: str
    rule: Rule
    region: Region
    speed: float | None = None
    watch: tuple[str, ...] = ("tool",)
    margin: float = 0.0
    posture: JointWindow | None = None


@frozen(eq=False)
class Cell:
    """A cell for a robot: names for programs, and bodies and zones in the order of the file.

    Names are in upper case. `frames` has parents before what hangs on them; `joints` are joint positions (n,) [rad or m]; `inputs` are
    the controller's variables. `places` says where a name stands in `source`, by the table (frames, joints, inputs, outputs) and the name; `zone_places`
    where the name of a zone does.
    """

    source: SourceFile
    frames: Mapping[str, CellFrame]
    joints: Mapping[str, Array]
    inputs: Mapping[str, str]
    outputs: Mapping[str, CellOutput]
    obstacles: tuple[Obstacle, ...]
    zones: tuple[Zone, ...]
    places: Mapping[tuple[str, str], Span]
    zone_places: Mapping[str, Span] = field(default_factory=dict)
