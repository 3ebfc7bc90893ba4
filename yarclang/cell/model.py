"""The model of a robot cell that the compiler uses: plain data in SI units, already checked, for one robot.

`yarclang.cell.description` creates it from a cell.toml. Arrays are float64 and read-only. Transforms are
named so that neighbouring names cancel: `base_from_x` maps coordinates of x to the robot's {B},
`flange_from_x` to its {FLANGE}.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.keeping import Height, Keep, Pointed, Sight, Tilt
from yarclang.frozen import frozen
from yarclang.shapes import Box, Capsule, Cylinder, Shape, Sphere
from yarclang.source import SourceFile, Span

Array = NDArray[np.float64]
Rule = Literal["allowed", "forbidden", "slow", "posture"]

PARTS = ("tool", "tcp", "elbow", "arm")
"""Words that name what a zone watches. A zone may also name links of the robot."""


@frozen(eq=False)
class Mount:
    """The place where an object is fixed: `transform` (4, 4) [m] is base_from_object, or flange_from_object
    if `on_flange`.
    """

    transform: Array
    on_flange: bool
    told: tuple[Array, ...] | None = field(default=None, compare=False)
    """The poses whose product is `transform`, in order from the root. Each pose has the numbers of the file,
    converted to SI: x y z and roll pitch yaw (6,), or x y z and qx qy qz qw (7,). None if `transform` was
    computed in another way.
    """


@frozen(eq=False)
class CellFrame:
    """A frame of the cell: its pose `parent_from_frame` (4, 4) [m] in its parent, and its resulting pose
    `mount` in {B} or {FLANGE}.

    `parent` is B, FLANGE, or the name of another frame of the cell.
    """

    name: str
    parent: str
    parent_from_frame: Array
    mount: Mount

    @property
    def told(self) -> Array | None:
        """The numbers of `parent_from_frame` in the file, converted to SI, in the form of `Mount.told`; None
        if the place was computed.
        """
        return self.mount.told[-1] if self.mount.told else None


@frozen(eq=False)
class Grip:
    """The gripper that an output closes and opens, or the lock of a tool changer.

    Attributes:
        value: value of the output that closes the gripper; any other value opens it.
        flange_from_grip: (4, 4) pose of the gripper's frame [m].
        reach: largest distance of a workpiece from the origin of the gripper's frame at which the closing
            gripper takes it [m]. It takes the nearest workpiece.
        frame: name of the gripper's frame.
        tool: the tool to which the gripper belongs, if that tool can be changed.
        changes: True for the lock of a tool changer, which holds tools instead of workpieces.
    """

    frame: str
    flange_from_grip: Array
    reach: float
    value: float
    tool: str | None = None
    changes: bool = False


@frozen(eq=False)
class Removal:
    """The effect of an output with which a machine removes workpieces.

    When the output gets `value`, workpieces within `reach` [m] of the place `base_from_place` (4, 4) [m] in
    the cell are removed. `frame` is the name of the place's frame.
    """

    frame: str
    base_from_place: Array
    reach: float
    value: float


@frozen
class CellOutput:
    """An output: the controller's variable, and its value after any stop, hold or fault (None: unchanged).

    `grip` is set if the output moves a gripper, `removal` if the output makes a machine remove workpieces.
    """

    variable: str
    safe: float | None
    grip: Grip | None = None
    removal: Removal | None = None


@frozen(eq=False)
class Weight:
    """The mass distribution of a body: its centre of mass (3,) [m], and its inertia (3, 3) [kg m^2] about
    this centre, both in the body's frame.
    """

    center: Array
    inertia: Array


@frozen(eq=False)
class Obstacle:
    """A body that the robot must not touch or, with a mount on the flange, a body that the robot carries.

    Attributes:
        margin: distance that other bodies must keep from it [m].
        is_part: True for a workpiece that grippers take.
        mass: mass of a workpiece [kg]; None if it isn't known.
        is_sure: False for a workpiece that may also be at another place, depending on decisions at run time.
        of_tool: True for a body of a tool that can be changed.
        weight: distribution of the mass, if it doesn't follow from the shape.
    """

    name: str
    shape: Shape
    mount: Mount
    margin: float
    mass: float | None = None
    is_sure: bool = True
    is_part: bool = False
    of_tool: bool = False
    weight: Weight | None = None


@frozen(eq=False)
class RackTool:
    """A tool that the robot takes from a place in a rack, and puts back there.

    Attributes:
        place: base_from_flange (4, 4) [m] where the robot takes the tool and puts it back.
        flange_from_body: (4, 4) pose of the tool's first body on the flange [m].
        more: the tool's other bodies: body_from_shape (4, 4) [m], and the shape.
        frames: the names of the frames on the flange that exist only while the tool is on the flange, in
            alphabetical order.
        lock: the variable of the changer's output.
        grippers: the variables of the outputs of the grippers that belong to the tool.
        reach: largest distance of the flange from `place` when the changer locks or unlocks [m].
    """

    place: Mount
    flange_from_body: Array
    more: tuple[tuple[Array, Shape], ...]
    frames: tuple[str, ...]
    lock: str
    grippers: tuple[str, ...]
    reach: float

    @property
    def base_from_body(self) -> Array:
        """The pose of the tool's first body in {B} while the tool is in the rack (4, 4) [m]."""
        placed: Array = self.place.transform @ self.flange_from_body
        return placed


@frozen(eq=False)
class Part:
    """A kind of workpiece: a body that grippers take and put down. `body` is the workpiece at its initial
    place.

    `count` workpieces of the kind come one after the other: the next workpiece is at the initial place as
    soon as the previous workpiece has been taken away. `frame` is the name of the frame in which the place is
    given. `rack` is set for a tool that a tool changer takes; `body` is then the first body of the tool.
    """

    body: Obstacle
    count: int = 1
    frame: str = field(default="", compare=False)
    rack: RackTool | None = None


@frozen
class Touch:
    """A workpiece and another body that are allowed to come nearer to each other than their margins, usually
    because a gripper takes the workpiece or puts it down.

    Attributes:
        part: name of the workpiece.
        other: name of the other body. None means all bodies on the flange that aren't workpieces, such as the
            gripper. The name of the workpiece itself means this workpiece at its other possible places.
        least: smallest allowed distance [m]. It is negative if the bodies may overlap up to a certain depth,
            and minus infinity if any overlap is allowed.
    """

    part: str
    other: str | None
    least: float


@frozen
class CellAllowance:
    """A pair of bodies that are allowed to touch during motions that lead to a frame, or during motions that
    leave a frame.

    Attributes:
        first: name of one body, in upper case.
        second: name of the other body, in alphabetical order after the first.
        leads_to: name of the frame for motions that lead to it: their goals are given in this frame. Empty if
            `leaves` is given instead.
        leaves: name of the frame for motions that leave it: the goal of the previous motion is given in this
            frame. Empty if `leads_to` is given instead.
        line: line of the entry in the cell's file.
    """

    first: str
    second: str
    leads_to: str
    leaves: str
    line: int


@frozen
class Item:
    """A workpiece or tool at its current place or, if `is_sure` is False, at a possible place.

    `pose` has the bytes of a transform (4, 4) [m]: base_from_part, or flange_from_part if a gripper holds the
    workpiece. `gripper` is then the variable of the gripper's output. `number` is the number of the workpiece
    among those of its kind, from 1.
    """

    part: Part
    number: int
    pose: bytes
    gripper: str | None = None
    is_sure: bool = True

    @property
    def name(self) -> str:
        """The workpiece's name in messages: BOX, or BOX 3 if several come one after the other."""
        return f"{self.part.body.name} {self.number}" if self.part.count > 1 else self.part.body.name

    @property
    def transform(self) -> Array:
        """The pose as a matrix (4, 4) [m]."""
        return np.frombuffer(self.pose).reshape(4, 4)

    @property
    def solids(self) -> tuple[tuple[Array, Shape], ...]:
        """The workpiece's shapes, each with its pose (4, 4) [m]: in {B}, or in {FLANGE} if a gripper holds
        it.
        """
        own = self.transform
        more = () if self.part.rack is None else self.part.rack.more
        return (own, self.part.body.shape), *((own @ placed, shape) for placed, shape in more)


@frozen
class Expected:
    """A workpiece that isn't in the cell yet: number `number` of its kind. The SET at step `taken` takes the
    previous workpiece. As soon as the previous workpiece no longer blocks the place, this one appears there.
    """

    part: Part
    number: int
    taken: int


@frozen
class Parts:
    """A state of the cell's workpieces. `items` are the workpieces in the cell, `closed` the grippers that
    are certainly closed (by the variables of their outputs), and `expected` the workpieces that are still to
    come.
    """

    items: tuple[Item, ...]
    closed: frozenset[str] = frozenset()
    expected: tuple[Expected, ...] = ()

    def held(self, gripper: str | None = None) -> tuple[Item, ...]:
        """Return the workpieces that a gripper holds; for None, the workpieces that any gripper holds."""
        return tuple(one for one in self.items if one.gripper is not None and gripper in (None, one.gripper))

    @property
    def tools(self) -> tuple[str, ...]:
        """The names of the changeable tools that are, or may be, on the flange."""
        return tuple(one.name for one in self.held() if one.part.rack is not None)


@frozen
class Leaving:
    """A gripper that has taken or put down workpieces, and is still near them.

    `moved` are the names of the workpieces. `closes` is True if the gripper took them, and False if it put
    them down. `touches` are the pairs of bodies that are allowed to touch until the gripper has left.
    """

    moved: tuple[str, ...]
    closes: bool
    touches: tuple[Touch, ...]


@frozen
class Present:
    """The state of the workpieces when a program starts, if they aren't at the places in the cell's file.

    `leaving` are the grippers that are still at the workpieces that they took or put down. `goes_on` is True
    for a line of a terminal session, after which another line may close or open a gripper.
    """

    parts: Parts
    leaving: tuple[Leaving, ...] = ()
    goes_on: bool = False


@frozen(eq=False)
class Sensor:
    """A sensor that sets an input.

    The input is ON while a workpiece or the robot is in the sensor's `region`, placed at `mount`. For a
    sensor with a `gripper` (the variable of the gripper's output), it is ON while this gripper holds a
    workpiece. If `inverted` is True, ON and OFF are exchanged.
    """

    input: str
    inverted: bool
    region: Sphere | Capsule | None = None
    mount: Mount | None = None
    gripper: str | None = None


@frozen(eq=False)
class ShapeRegion:
    """The points in a fixed shape around the origin of `base_from_shape` (4, 4) [m]."""

    base_from_shape: Array
    shape: Box | Sphere | Cylinder | Capsule
    told: tuple[Array, ...] | None = field(default=None, compare=False)
    """The poses of the shape's frames as the file gives them, in the form of `Mount.told`. The judge computes
    the region's place again from these numbers.
    """


@frozen(eq=False)
class HalfSpace:
    """The points p in {B} with normal · p >= offset: `normal` (3,) has length 1, `offset` is in m."""

    normal: Array
    offset: float
    told: tuple[Array, ...] | None = field(default=None, compare=False)
    """The pose of a frame as the file gives it, in the form of `Mount.told`. In the axes of this frame, the
    normal is `own_normal`.
    """
    own_normal: Array | None = field(default=None, compare=False)

    @property
    def base_from_plane(self) -> Array:
        """A frame (4, 4) [m] on the border plane. Its z axis is the normal, and its origin is the point of
        the plane nearest to the origin of {B}.
        """
        placed = np.eye(4)
        # choose any two directions perpendicular to the normal
        across = np.cross(self.normal, np.eye(3)[int(np.argmin(np.abs(self.normal)))])
        across /= np.linalg.norm(across)
        placed[:3, :3] = np.column_stack([across, np.cross(self.normal, across), self.normal])
        placed[:3, 3] = self.normal * self.offset
        return placed


@frozen(eq=False)
class JointWindow:
    """The joint positions from `lower` (n,) to `upper` (n,) [rad or m]. Both bounds are infinite for a joint
    that isn't limited.
    """

    lower: Array
    upper: Array


@frozen(eq=False)
class StartZone:
    """A range of joint positions from which the robot may move to a program's start without an order of the
    user. This motion is also planned and proved.
    """

    name: str
    window: JointWindow


Region = ShapeRegion | HalfSpace | JointWindow | Tilt | Sight
Unplaced = JointWindow | Pointed
"""Regions that aren't volumes in the cell: regions of joint positions, and of some flange poses."""


@frozen(eq=False)
class Zone:
    """A region of space, joint positions or flange poses, with a rule for the bodies that it watches.

    The rules are `allowed`: stay inside; `forbidden`: stay outside; `slow`: inside, no faster than `speed`
    [m/s]; `posture`: while anything watched is inside, the joints stay in the joint window `posture`. `speed`
    and `posture` are None for the other rules.

    `watch` has the names of what is watched: words of `PARTS`, or links of the URDF. `tcp` is the origin of
    the frame that a command moves, `tool` is this origin and all bodies that the robot carries, `elbow` is a
    point (`yarclang.robot.kinematics.elbow`), `arm` is all links that the joints move.

    Everything watched keeps `margin` [m] from the border of an allowed or forbidden zone; slow and posture
    zones already take effect at a distance of `margin` outside their border. If the region is a joint window
    and the rule is `allowed` or `forbidden`, only the joints are watched. If the region is a `Tilt` or a
    `Sight`, the rule is `allowed`, and the pose of the flange is watched. `keep` is the path constraint from
    which the zone was created.
    """

    name: str
    rule: Rule
    region: Region
    speed: float | None = None
    watch: tuple[str, ...] = ("tool",)
    margin: float = 0.0
    posture: JointWindow | None = None
    keep: Keep | None = None

    @staticmethod
    def of(keep: Keep) -> Zone:
        """Return the zone that a path constraint (KEEP rule) defines."""
        name, region = f"KEEP {keep.words}", keep.region
        if not isinstance(region, Height):
            return Zone(name, "allowed", region, watch=(), keep=keep)
        normal = np.array(region.up)
        normal.flags.writeable = False
        return Zone(name, "allowed", HalfSpace(normal, region.level + region.limit), watch=(), keep=keep)


@frozen(eq=False)
class Cell:
    """A cell for a robot: the names that programs can use, and the bodies and zones in the order of the
    cell's file.

    Names are in upper case. `frames` has parents before their children; `joints` are joint positions (n,)
    [rad or m]; `inputs` are the controller's variables. `places` has the position of each name in the text
    `source`, by the table (frames, joints, inputs, outputs) and the name; `zone_places` has the positions of
    the zones' names.

    `parts` are the workpieces that grippers take. The collision check ignores `parts`. For each instant of a
    program, another cell is made in which the workpieces are obstacles (`yarclang.handling.surroundings`). In
    that cell, `touches` are the pairs of bodies that may touch when workpieces are taken and put down.
    `allowed` are the pairs of bodies that the program or an entry of `allowances` allows to touch: names in
    upper case, the two of a pair in alphabetical order. `present` is the state of the workpieces when a
    program starts; None for the places in the file.

    `starts` are the ranges of joint positions from which a robot may move to the start of a program without
    an order of the user.
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
    parts: tuple[Part, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    touches: tuple[Touch, ...] = ()
    present: Present | None = None
    starts: tuple[StartZone, ...] = ()
    allowances: tuple[CellAllowance, ...] = ()
    allowed: frozenset[tuple[str, str]] = frozenset()

    @property
    def rules(self) -> tuple[Keep, ...]:
        """The path constraints that all motions must satisfy (`[[keep]]`)."""
        return tuple(zone.keep for zone in self.zones if zone.keep is not None)

    @property
    def grips(self) -> Mapping[str, Grip]:
        """The grippers, by the variables of their outputs."""
        return {one.variable: one.grip for one in self.outputs.values() if one.grip is not None}

    @property
    def removals(self) -> Mapping[str, Removal]:
        """The machines that remove workpieces, by the variables of their outputs."""
        return {one.variable: one.removal for one in self.outputs.values() if one.removal is not None}

    @property
    def lock(self) -> CellOutput | None:
        """The output of the tool changer's lock; None if the cell has none."""
        return next((one for one in self.outputs.values() if one.grip is not None and one.grip.changes), None)

    @property
    def tools(self) -> tuple[str, ...]:
        """The names of the tools that can be changed."""
        return tuple(one.body.name for one in self.parts if one.rack is not None)
