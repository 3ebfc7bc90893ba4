"""The checked program: motions and other primitive steps in SI units. All names are resolved.

Arrays are float64 and read-only. Joint positions q are (n,) in rad (m for a prismatic joint), poses
are (4, 4) homogeneous transforms. `base_from_moving` maps coordinates of the moving frame to
the robot's base {B}; `flange_from_moving` is the pose of the moving frame on {FLANGE}.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.keeping import Keep
from yarclang.cell.model import Cell
from yarclang.decisions import Register, Searched, Shifted, Value, Watch, bits_of
from yarclang.frozen import frozen
from yarclang.source import SourceFile, Span

Array = NDArray[np.float64]


@frozen(eq=False)
class FrameLink:
    """A frame with its pose in its parent frame. The chain of parents ends at {B} or {FLANGE}.

    Attributes:
        name: the frame's name without braces.
        parent_from_frame: (4, 4) transform from the frame to its parent.
        parent: the parent frame; None for {B} and {FLANGE} themselves.
        source: file that declares the frame; None for frames of the robot.
        span: position of the declaration in `source`; None for frames of the robot.
        told: the numbers of `parent_from_frame` as written, in SI units: x y z and roll pitch yaw (6,), or x
            y z and qx qy qz qw (7,). None for frames of the robot.
    """

    name: str
    parent_from_frame: Array
    parent: FrameLink | None = None
    source: SourceFile | None = None
    span: Span | None = None
    told: Array | None = field(default=None, compare=False)

    def is_same(self, other: FrameLink) -> bool:
        """Return True if two objects describe the same frame. A line that is parsed again gives a new object
        for the same frame.
        """
        if self is other:
            return True
        if self.name != other.name or not np.array_equal(self.parent_from_frame, other.parent_from_frame):
            return False
        if self.parent is None or other.parent is None:
            return self.parent is other.parent
        return self.parent.is_same(other.parent)


@frozen(eq=False)
class Told:
    """A pose with the numbers that the program gives, for checkers that compute the transforms themselves.

    Attributes:
        numbers: in SI units: x y z and roll pitch yaw (6,), or x y z and qx qy qz qw (7,).
        base: the frame in which the numbers are given.
        moving: the frame that is moved.
    """

    numbers: Array
    base: FrameLink
    moving: FrameLink


@frozen
class Origin:
    """The command of the source that a step of the checked program comes from.

    Spans are positions in the source, for fixes that replace or insert text there.

    Attributes:
        index: the command's index as printed, such as P0001; empty for a line without one.
        name: the command's full name, such as MOVEJ_RPY_LSPB.
        source: the source file.
        span: the whole command.
        time_span: the motion time.
        time_unit: unit of the motion time in the source.
        length_unit: unit of lengths in the source.
        angle_unit: unit of angles in the source.
        end_span: empty span at the end of the command, where a fix adds an option.
        name_span: the command's name.
        values_span: empty span at the start of the values, where a fix adds a waypoint.
        stretch_span: the factor of STRETCH.
        time_given: for a motion time that is a parameter of a SUB, the argument of the call and its position.
        place: for a command in a loop or a SUB, the calls and passes that lead to it, outermost first, and
            the command itself: P0020(I=2)>P0010.
        moving: the frame that is moved, if the command names one.
        tool: the frame that zones treat as the tool: `moving` for a Cartesian goal; for a joint goal, the
            frame named on the line or by DEFAULT.
        base: the frame in which the values are given, if the command names one.
    """

    index: str
    name: str
    source: SourceFile
    span: Span
    time_span: Span | None = None
    time_unit: str = "s"
    length_unit: str = "mm"
    angle_unit: str = "deg"
    end_span: Span | None = None
    name_span: Span | None = None
    values_span: Span | None = None
    stretch_span: Span | None = None
    time_given: str = ""
    place: str = ""
    moving: FrameLink | None = field(default=None, compare=False)
    tool: FrameLink | None = field(default=None, compare=False)
    base: FrameLink | None = field(default=None, compare=False)

    @property
    def label(self) -> str:
        """Name of the command in messages: its place, or else its index; empty if it has neither."""
        return self.place or self.index


@frozen(eq=False)
class JointGoal:
    """A joint position q (n,)."""

    q: Array


@frozen(eq=False)
class JointDelta:
    """A change of the joint position (n,), relative to the current position."""

    dq: Array


@frozen(eq=False)
class PoseGoal:
    """A goal of a motion, as a pose of the moving frame.

    Attributes:
        base_from_moving: (4, 4) goal of the moving frame in {B}.
        flange_from_moving: (4, 4) moving frame on {FLANGE}.
        near: (n,) joint positions. Of all inverse kinematics solutions, the nearest to them is chosen. None:
            nearest to the robot's current position.
        told: the numbers as the program gives them; None for a computed pose.
        shifted: True if the motion is inside an OFFSET, and the pose moves with the shifted frame.
    """

    base_from_moving: Array
    flange_from_moving: Array
    near: Array | None = None
    told: Told | None = field(default=None, compare=False)
    shifted: bool = False


@frozen(eq=False)
class PoseDelta:
    """A translation and a rotation of the moving frame, relative to its current pose, along given axes.

    The pose (p, Q) becomes (p + R d, R D R^T Q) with d = `shift` [m] and D = `turn` (3, 3).
    R is `axes` if the axes are fixed to {B}. With `axes_on_flange`, R is the flange's rotation at the start
    times `axes` (flange_from_axes).

    Attributes:
        shift: (3,) translation d along the axes [m].
        turn: (3, 3) rotation D about the axes.
        axes: (3, 3) directions of the axes in {B} or on {FLANGE}.
        axes_on_flange: True if `axes` is given on {FLANGE}.
        flange_from_moving: (4, 4) moving frame on {FLANGE}.
        told: the change as it was written; None for a computed change.
        shifted: True if the motion is inside an OFFSET, and the axes rotate with the shifted frame.
    """

    shift: Array
    turn: Array
    axes: Array
    axes_on_flange: bool
    flange_from_moving: Array
    told: Told | None = field(default=None, compare=False)
    shifted: bool = False


@frozen
class Reading:
    """A number of the program that is a distance or an angle, depending on the motion that uses it.

    If the number is a speed, `length` is in m/s and `angle` in rad/s.

    Attributes:
        length: the number as a distance [m]; None if the command has no unit of length.
        angle: the number as an angle [rad]; None if the command has no unit of angle.
        or_less: True if a smaller value is allowed: `BLEND <=10` uses as much as there is room for.
    """

    length: float | None
    angle: float | None
    or_less: bool = False


@frozen
class Timing:
    """Duration of a motion, or how the planner chooses it.

    Attributes:
        duration: motion time [s]; None for the shortest time that the limits and `speed` allow.
        share: share of the limits of velocity, acceleration and jerk that the shortest motion may use
            (`[50%]`).
        ramp: share of the limits of acceleration and jerk that any motion may use (`ACC 30%`).
        speed: cruise speed of the moving frame's origin (`[V 250]`), or angular speed of the frame if the
            origin doesn't move. If `speed` is given, `duration` is None.
        ceiling: speed [m/s] that the origin of the moving frame, or of the tool, never exceeds (`[V<=250]`),
            in a motion that is otherwise as fast as possible.
    """

    duration: float | None
    share: float = 1.0
    ramp: float = 1.0
    speed: Reading | None = None
    ceiling: float | None = None


Goal = JointGoal | JointDelta | PoseGoal | PoseDelta


@frozen
class Allowed:
    """Two bodies that may touch during a motion, as the command names them (ALLOW), in upper case.

    Attributes:
        first: name of one body.
        second: name of the other body, in alphabetical order after the first.
        row: row of the names in the command, from 0.
        start: first column of the names.
        end: column after the names.
        cell_line: line of the cell's file that allows the contact; None if the command itself allows it.
    """

    first: str
    second: str
    row: int = field(default=0, compare=False)
    start: int = field(default=1, compare=False)
    end: int = field(default=1, compare=False)
    cell_line: int | None = field(default=None, compare=False)

    def span(self, origin: Origin) -> Span:
        """Return the place of the names in the source of their command."""
        return Span.on_line(origin.span.line + self.row, self.start, self.end)


class MotionHead:
    """Common interface of all motions.

    Every motion also has the following fields.

    Attributes:
        origin: the command.
        profile: name of the time profile, such as LSPB.
        timing: the duration, or how to choose it.
        tolerance: largest distance of the moving frame from the path [m]; None for the robot's default.
        blend: distance or angle from the end at which the motion may leave the path, to continue with the
            next motion without a stop; None if the motion ends at rest.
        allowed: pairs of bodies that may touch during the motion.
        keeps: path constraints (KEEP rules) for the whole path of the motion.
    """

    __slots__ = ()
    leads_frame: bool = False
    """True if the path is defined for the moving frame, not for the joints."""

    @property
    def goals(self) -> tuple[Goal, ...]:
        """Goals that the command gives, with the end of the motion as the last one. Empty for a timetable,
        whose rows are one array.
        """
        raise NotImplementedError

    @property
    def end(self) -> Goal:
        """The goal at which the motion ends."""
        return self.goals[-1]

    @property
    def besides(self) -> tuple[Array | None, ...]:
        """Further arrays that determine the path, such as a via point or a table."""
        return ()

    @property
    def flange_from_moving(self) -> Array | None:
        """Pose of the moving frame on the flange (4, 4); None if all goals are joint goals."""
        poses = (one for one in self.goals if isinstance(one, PoseGoal | PoseDelta))
        return next((one.flange_from_moving for one in poses), None)


@frozen
class Search:
    """The condition that ends a motion early: an input has a certain value.

    Attributes:
        variable: the controller's variable of the input.
        value: the input's value that ends the motion.
        name: the input's name in the program.
        flag: register that becomes 1 when the input ends the motion.
        depth: register that then gets the distance covered by the frame [0.01 mm]; empty for none.
    """

    variable: str
    value: float
    name: str
    flag: str = ""
    depth: str = ""


@frozen(eq=False)
class JointMove(MotionHead):
    """A motion along a straight line in joint space."""

    origin: Origin
    goal: JointGoal | JointDelta | PoseGoal
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None
    search: Search | None = None
    allowed: tuple[Allowed, ...] = ()
    keeps: tuple[Keep, ...] = ()

    @property
    def goals(self) -> tuple[JointGoal | JointDelta | PoseGoal]:
        """The goal."""
        return (self.goal,)


@frozen(eq=False)
class AvoidMove(MotionHead):
    """A motion in joint space to the goal, on a path around all obstacles.

    The path is straight if the straight line is free. Otherwise it is a natural cubic spline (as in
    SplineMove) through waypoints that the planner finds.
    """

    origin: Origin
    goal: JointGoal | PoseGoal
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None
    allowed: tuple[Allowed, ...] = ()
    keeps: tuple[Keep, ...] = ()

    @property
    def goals(self) -> tuple[JointGoal | PoseGoal]:
        """The goal."""
        return (self.goal,)


@frozen(eq=False)
class LineMove(MotionHead):
    """A motion of the moving frame along a straight line. The frame rotates about one fixed axis by the
    smaller angle.

    If `avoids` is True, the planner replaces the motion by one or more LineMoves in which `avoids` is False:
    one if the straight line is free, otherwise several around the obstacles. The last of them has the
    original goal.
    """

    leads_frame = True
    origin: Origin
    goal: PoseGoal | PoseDelta
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None
    search: Search | None = None
    allowed: tuple[Allowed, ...] = ()
    keeps: tuple[Keep, ...] = ()
    avoids: bool = False

    @property
    def goals(self) -> tuple[PoseGoal | PoseDelta]:
        """The goal."""
        return (self.goal,)


@frozen(eq=False)
class ArcMove(MotionHead):
    """A motion of the moving frame's origin along the circular arc from its current position through `via` to
    the goal.

    The frame rotates about one fixed axis by the smaller angle, in proportion to the arc length. `via` is
    (3,) in {B} [m].
    """

    leads_frame = True
    origin: Origin
    via: Array
    goal: PoseGoal
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None
    allowed: tuple[Allowed, ...] = ()
    keeps: tuple[Keep, ...] = ()

    @property
    def goals(self) -> tuple[PoseGoal]:
        """The goal."""
        return (self.goal,)

    @property
    def besides(self) -> tuple[Array]:
        """The via point."""
        return (self.via,)


@frozen(eq=False)
class PoseSplineMove(MotionHead):
    """A C2 curve of the moving frame from its current pose through all waypoints.

    All waypoints have the same `flange_from_moving`. Positions and unit quaternions are natural cubic
    splines over a parameter u; the quaternions are then normalised. Of the two signs of each quaternion, the
    one nearer to the previous quaternion is used.

    From one waypoint to the next, u grows by sqrt(distance^2 + (`TURN_CHORD` * angle)^2). Neighbours for
    which u would grow by 1 um or less count as one waypoint.
    """

    leads_frame = True
    origin: Origin
    waypoints: tuple[PoseGoal, ...]
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None
    allowed: tuple[Allowed, ...] = ()
    keeps: tuple[Keep, ...] = ()

    @property
    def goals(self) -> tuple[PoseGoal, ...]:
        """The waypoints."""
        return self.waypoints


TURN_CHORD = 0.1
"""Growth of a spline's parameter u for a rotation by 1 rad between two waypoints [m]."""


@frozen(eq=False)
class SplineMove(MotionHead):
    """A natural cubic spline in joint space from the current position through all waypoints.

    The parameter is the chord length in joint space. Equal neighbours count as one waypoint.
    """

    origin: Origin
    waypoints: tuple[JointGoal | PoseGoal, ...]
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None
    allowed: tuple[Allowed, ...] = ()
    keeps: tuple[Keep, ...] = ()

    @property
    def goals(self) -> tuple[JointGoal | PoseGoal, ...]:
        """The waypoints."""
        return self.waypoints


@frozen(eq=False)
class Timetable:
    """Positions of all joints at given times, with optional velocities and accelerations.

    Between two rows each joint follows the quintic polynomial through the positions, velocities and
    accelerations of both rows. If only velocities are given, it follows the cubic polynomial through
    positions and velocities. If neither is given, one cubic spline in time joins all rows, with continuous
    acceleration and zero velocity at both ends.

    Attributes:
        times: (k,) times since the start of the motion [s], strictly increasing. A first time of 0 makes the
            first row the start of the motion. Otherwise the motion starts at the robot's current position,
            with zero velocity and acceleration.
        positions: (k, n) [rad or m].
        velocities: (k, n) [per s], or None for all rows. Zero in the last row.
        accelerations: (k, n) [per s^2], or None for all rows; only with velocities.
    """

    times: Array
    positions: Array
    velocities: Array | None = None
    accelerations: Array | None = None

    @property
    def begins(self) -> bool:
        """True if the first row is the start of the motion, at time 0."""
        return bool(self.times[0] == 0.0)

    def stretched(self, factor: float) -> Timetable:
        """Return the timetable with all times multiplied by a factor, along the same path."""
        if factor == 1.0:
            return self
        parts = (
            self.times * factor,
            None if self.velocities is None else self.velocities / factor,
            None if self.accelerations is None else self.accelerations / factor**2,
        )
        for part in parts:
            if part is not None:
                part.setflags(write=False)
        times, velocities, accelerations = parts
        assert times is not None
        return Timetable(times, self.positions, velocities, accelerations)


@frozen(eq=False)
class TimedMove(MotionHead):
    """A motion of all joints along a timetable, from the current position to rest at the last row.

    Attributes:
        origin: the command.
        table: the rows as written.
        within: (n,) largest deviation of each joint from the table at the same time [rad or m].
        stretch: factor that multiplies all times.
        timing: `duration` is the last time, multiplied by `stretch`.
        profile: empty, since the table defines the speeds.
        tolerance: None, since `within` replaces it.
        blend: None, since the motion ends at rest.
        file: the file with the table, as named in the program; empty if the rows are in the program itself.
    """

    origin: Origin
    table: Timetable
    within: Array
    stretch: float
    timing: Timing
    profile: str = ""
    tolerance: float | None = None
    blend: Reading | None = None
    file: str = ""
    allowed: tuple[Allowed, ...] = ()
    keeps: tuple[Keep, ...] = ()

    @property
    def asked(self) -> Timetable:
        """The table with its times multiplied by `stretch`."""
        return self.table.stretched(self.stretch)

    @property
    def goals(self) -> tuple[()]:
        """Empty, since the table has its positions in one array."""
        return ()

    @property
    def end(self) -> JointGoal:
        """The last row."""
        return JointGoal(self.table.positions[-1])

    @property
    def besides(self) -> tuple[Array | None, ...]:
        """The arrays of the table, the allowed deviation of the joints, and the stretch factor."""
        table = self.table
        stretch = np.array(self.stretch)
        return table.times, table.positions, table.velocities, table.accelerations, self.within, stretch

    @property
    def waypoints(self) -> tuple[JointGoal, ...]:
        """Positions of all rows after the start."""
        return tuple(JointGoal(q) for q in self.table.positions[int(self.table.begins) :])


@frozen
class Signal:
    """An input or output of the controller, as a program names it.

    Attributes:
        name: name in the program.
        variable: the controller's variable; for a group, the variables of its bits, lowest first.
    """

    name: str
    variable: str

    @property
    def bits(self) -> tuple[Signal, ...]:
        """The single signals: the signal itself, or the bits of a group, named JOB.0, JOB.1 and so on."""
        variables = bits_of(self.variable)
        if len(variables) == 1:
            return (self,)
        return tuple(Signal(f"{self.name}.{place}", one) for place, one in enumerate(variables))


@frozen
class Dwell:
    """A pause of `duration` [s] at rest."""

    origin: Origin
    duration: float


@frozen
class SetOutput:
    """A SET: an output gets a value after the previous motion has ended.

    `tool` is set only if the output locks a tool changer. It then names the tool that is on the flange
    afterwards, as declared by TOOL; it is empty if no tool is on the flange.
    """

    origin: Origin
    output: Signal
    value: float
    tool: str | None = None


@frozen
class WaitInput:
    """A wait at rest until an input has a value. If that takes longer than `timeout` [s], the program ends
    with a fault (None: no limit).
    """

    origin: Origin
    input: Signal
    value: float
    timeout: float | None


@frozen
class WaitUntil:
    """A wait at rest until a condition is true. If that takes longer than `timeout` [s], the program ends
    with a fault (None: no limit).

    Each evaluation reads all inputs of the condition once.
    """

    origin: Origin
    condition: Value
    timeout: float | None


@frozen
class Hold:
    """A wait at rest until the operator continues. `text` is the question to the operator.

    If `register` is not empty, the operator enters a number for this register.
    """

    origin: Origin
    text: str
    register: str = ""


@frozen
class Say:
    """A message to the operator, without a wait. `{N}` in the text is replaced by the value of the register
    N.

    If `teaches` isn't empty, the message teaches a position: the robot's position (its joints, or the pose of
    {TCP} in {B}) is shown, and stored under the name in the text.
    """

    origin: Origin
    text: str
    teaches: Literal["", "joints", "pose"] = ""


@frozen(eq=False)
class Offset:
    """A frame that registers shift at run time, for the steps of one branch.

    Attributes:
        name: name of the frame in the program.
        base_from_frame: (4, 4) the frame as it is declared, in {B}.
        registers: register with the value for each of `SHIFTS` [0.01 mm or 0.01 deg]; empty for none.
        flag: register that becomes 1 if the branch can be carried out in the shifted frame.
        parts: names of the cell's workpieces that are placed in the frame.
        link: the frame and its parents.
    """

    name: str
    base_from_frame: Array
    registers: tuple[str, ...]
    flag: str
    parts: tuple[str, ...] = ()
    link: FrameLink | None = field(default=None, compare=False)


@frozen
class When:
    """The start of a branch: the steps up to the matching Else or EndWhen are carried out if a condition is
    true.

    Attributes:
        origin: the command.
        condition: the condition.
        again: True if the condition uses the input values that the enclosing WHEN has read. This When is then
            the first step in the second branch of that WHEN. A CASE thus reads its inputs only once.
        within: time [s] for which the robot waits at rest until the condition is true; None: decide at once.
        offset: the frame that is shifted in the first branch, which is planned and proved again before the
            decision; None for an ordinary branch.
    """

    origin: Origin
    condition: Value
    again: bool = False
    within: float | None = None
    offset: Offset | None = None


@frozen
class Else:
    """The start of the second branch, which is carried out if the condition of the When is false."""

    origin: Origin


@frozen
class EndWhen:
    """The end of a WHEN. Both branches end here, at the same joint positions."""

    origin: Origin


@frozen
class Finish:
    """An end of the program at rest, in success or as a fault. No step follows in the same branch.

    Attributes:
        origin: the command.
        fails: True for a fault.
        text: the reason of the fault.
    """

    origin: Origin
    fails: bool = False
    text: str = ""


@frozen
class Loop:
    """The start of a loop: the steps up to the matching EndLoop are repeated.

    Each pass begins at the joint positions at which the first pass begins.
    """

    origin: Origin


@frozen
class NextPass:
    """The start of the next pass of the innermost loop, in the same state as the first pass.

    No step follows in the same branch.
    """

    origin: Origin


@frozen
class Exit:
    """An exit from the innermost loop: the program continues after its EndLoop.

    No step follows in the same branch.
    """

    origin: Origin


@frozen
class EndLoop:
    """The end of a loop. All Exits of the loop lead here, at the same joint positions."""

    origin: Origin


@frozen
class Assign:
    """A register or output that gets a value, which is computed while the robot is at rest."""

    origin: Origin
    target: str | Signal
    value: Value


@frozen
class Output:
    """An output that the program declares.

    Attributes:
        signal: the output.
        safe: value that the output gets at any stop, hold or fault; None: it keeps its value.
        step: size of one step of an analogue output, whose values are numbers of steps; None for others.
    """

    signal: Signal
    safe: float | None
    step: float | None = field(default=None, compare=False)


@frozen
class Stop:
    """The end of the program."""

    origin: Origin


@frozen
class Gap:
    """A command with errors: its effect, and the robot's position after it, are unknown."""


Motion = JointMove | AvoidMove | LineMove | ArcMove | SplineMove | PoseSplineMove | TimedMove
Action = (
    Dwell
    | SetOutput
    | WaitInput
    | WaitUntil
    | Hold
    | Say
    | When
    | Else
    | EndWhen
    | Assign
    | Finish
    | Loop
    | NextPass
    | Exit
    | EndLoop
)
Step = Motion | Action | Stop | Gap


@frozen(eq=False)
class WayOut:
    """The steps by which the robot withdraws after a watched input has stopped it during a motion.

    They begin at rest, at the start of that motion. The program ends after them.

    Attributes:
        name: the SUB with its commands; `Watch.then` of the inputs.
        origin: the first ON that calls the SUB.
        steps: motions, outputs and dwells.
    """

    name: str
    origin: Origin
    steps: tuple[Step, ...]


@frozen(eq=False)
class Program:
    """A checked program: the initial position of the robot, and the steps.

    Attributes:
        source: the source file.
        start: (n,) joint positions at the start [rad or m], within the joint limits.
        steps: the motions and other steps in order. A Gap marks an error: the program is still planned, to
            find further errors, but no controller text is written.
        outputs: the declared outputs.
        cell: the cell that a CELL line names; None without one.
        is_cut: True if loops and calls were only partly expanded, because of errors or because only a quick
            look was wanted. `steps` then contains a Gap.
        cells: for a section of a longer program: the cell during each motion, by the index of its step.
        registers: the declared registers.
        watches: the inputs that stop a motion.
        ways_out: the steps by which the robot withdraws after an input has stopped a motion.
    """

    source: SourceFile
    start: Array
    steps: tuple[Step, ...]
    outputs: tuple[Output, ...] = ()
    cell: Cell | None = None
    is_cut: bool = False
    cells: Mapping[int, Cell | None] | None = None
    registers: tuple[Register, ...] = ()
    watches: tuple[Watch, ...] = ()
    ways_out: tuple[WayOut, ...] = ()


def searches_of(program: Program) -> tuple[Searched, ...]:
    """Return the motions of a program that an input can end, in order."""
    return tuple(
        Searched(number, one.variable, one.value, one.name, one.flag, one.depth)
        for number, step in enumerate(program.steps)
        if isinstance(step, JointMove | LineMove) and (one := step.search) is not None
    )


def offsets_of(program: Program) -> tuple[Shifted, ...]:
    """Return the branches of a program in which a frame is shifted at run time, in order."""
    return tuple(
        Shifted(number, one.flag, one.name, one.registers)
        for number, step in enumerate(program.steps)
        if isinstance(step, When) and (one := step.offset) is not None
    )
