"""The checked program: a closed set of primitives in SI units, with every name resolved.

Arrays are float64 and read-only. Joint positions q are (n,) in rad (m for a prismatic joint), poses
are (4, 4) homogeneous transforms. `base_from_moving` maps coordinates of the moving frame to
the robot's base {B}; `flange_from_moving` is where the moving frame sits on {FLANGE}.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.model import Cell
from yarclang.decisions import Register, Searched, Value, Watch, bits_of
from yarclang.frozen import frozen
from yarclang.source import SourceFile, Span

Array = NDArray[np.float64]


@frozen(eq=False)
class FrameLink:
    """A frame, and how it sits in the next one towards {B} or {FLANGE}.

    `name` is without braces; `parent_from_frame` (4, 4). `parent` is None for {B} and {FLANGE} themselves, `source` and `span` for
    frames that come from the robot.
    """

    name: str
    parent_from_frame: Array
    parent: FrameLink | None = None
    source: SourceFile | None = None
    span: Span | None = None
    told: Array | None = field(default=None, compare=False)
    """The numbers of `parent_from_frame` as they were written, in SI: x y z and roll pitch yaw (6,) or qx qy qz qw (7,); None for the robot's frames."""


@frozen(eq=False)
class Told:
    """A pose as it was written, for readers that make the transforms themselves.

    `numbers` are in SI: x y z and roll pitch yaw (6,), or x y z and qx qy qz qw (7,). `base` is the frame that they are seen from, `moving` the frame that is moved.
    """

    numbers: Array
    base: FrameLink
    moving: FrameLink


@frozen
class Origin:
    """The command that a primitive comes from."""

    index: str
    """The command's index as printed: P0001 (empty for a line without one)."""
    name: str
    """The command's name in full: MOVEJ_RPY_LSPB."""
    source: SourceFile
    span: Span
    time_span: Span | None = None
    """Where the motion time stands in the source, for a fix that writes another one."""
    time_unit: str = "s"
    """The unit in which it stands there."""
    length_unit: str = "mm"
    angle_unit: str = "deg"
    """The units in which lengths and angles stand there, for a fix that writes other ones."""
    end_span: Span | None = None
    """An empty span where the command ends, for a fix that adds an option."""
    name_span: Span | None = None
    """Where the name stands, for a fix that writes another one."""
    values_span: Span | None = None
    """An empty span where the values begin, for a fix that adds a way-point."""
    stretch_span: Span | None = None
    """Where the factor of STRETCH stands, for a fix that writes another one."""
    time_given: str = ""
    """Of a motion time that is a parameter of a SUB, what was given for it, and where."""
    place: str = ""
    """Of a command in a loop or a SUB, what led to it, from outside in, and itself: P0020(I=2)>P0010."""
    moving: FrameLink | None = field(default=None, compare=False)
    """The frame that is moved, where one is said."""
    tool: FrameLink | None = field(default=None, compare=False)
    """The same, and of joint values, which it doesn't change, the frame that the line or DEFAULT names: what zones watch as the tool."""
    base: FrameLink | None = field(default=None, compare=False)
    """The frame in which the values are given, where one is said."""

    @property
    def label(self) -> str:
        """How messages call it: its place, else its index; empty where it has neither."""
        return self.place or self.index


@frozen(eq=False)
class JointGoal:
    """A joint position q (n,)."""

    q: Array


@frozen(eq=False)
class JointDelta:
    """A change of the joint position (n,), from where the robot stands."""

    dq: Array


@frozen(eq=False)
class PoseGoal:
    """The moving frame shall stand at `base_from_moving`.

    Of several joint positions, the nearest to `near` (n,) is taken; to where the robot stands, where that is None.
    """

    base_from_moving: Array
    flange_from_moving: Array
    near: Array | None = None
    told: Told | None = field(default=None, compare=False)
    """The same as it was written; None for a pose that was computed."""


@frozen(eq=False)
class PoseDelta:
    """Shift and turn the moving frame from where it stands, along given axes.

    From the pose p, Q to p + R d, R D R^T Q with d = `shift` [m] and D = `turn` (3, 3).
    R is `axes` itself where they are fixed to {B}, or, with `axes_on_flange`, the
    flange's rotation at the start times `axes` (flange_from_axes).
    """

    shift: Array
    turn: Array
    axes: Array
    axes_on_flange: bool
    flange_from_moving: Array
    told: Told | None = field(default=None, compare=False)
    """The same as it was written; None for a change that was computed."""


@frozen
class Reading:
    """A number that is a distance or an angle, as the motions that it belongs to say.

    `length` [m] is how it reads as a distance, `angle` [rad] as an angle; None where the command has no such unit. Of a
    speed, each is per s. `or_less` says that less will do: of a blend (`BLEND <=10`) as much as there is room for.
    """

    length: float | None
    angle: float | None
    or_less: bool = False


@frozen
class Timing:
    """How long a motion takes: `duration` [s], or the shortest that the limits allow (None).

    `share` is how much of the limits of velocity, acceleration and jerk the shortest may use (`[50%]`), `ramp`
    how much of those of acceleration and jerk any motion may use (`ACC 30%`). `speed` is the cruise speed of the
    moving frame (`[V 250]`): of its origin, or, where that stands still, its angular speed. The duration is None then.
    `ceiling` [m/s] is what the origin of the moving frame, or of the tool, never exceeds (`[V<=250]`), as fast as the motion could be.
    """

    duration: float | None
    share: float = 1.0
    ramp: float = 1.0
    speed: Reading | None = None
    ceiling: float | None = None


Goal = JointGoal | JointDelta | PoseGoal | PoseDelta


class MotionHead:
    """What can be asked of every motion, whichever kind it is.

    Besides, each has an `origin`, a `profile`, a `timing`, a `tolerance` [m] (how far the moving frame may be from the path; None: what the robot says) and a `blend`: how far from the end
    the path may be left to flow into the next motion without a stop (None: the motion ends at rest).
    """

    __slots__ = ()
    leads_frame: bool = False
    """True if the path is one of the moving frame, and not of the joints."""

    @property
    def goals(self) -> tuple[Goal, ...]:
        """The goals that the command names, the end last; none of a timetable, whose rows are one array."""
        raise NotImplementedError

    @property
    def end(self) -> Goal:
        """The goal at which the motion ends."""
        return self.goals[-1]

    @property
    def besides(self) -> tuple[Array | None, ...]:
        """What else decides over the path: a via point, a table."""
        return ()

    @property
    def flange_from_moving(self) -> Array | None:
        """The place of the moving frame on the flange (4, 4); None if all goals are of joints."""
        poses = (one for one in self.goals if isinstance(one, PoseGoal | PoseDelta))
        return next((one.flange_from_moving for one in poses), None)


@frozen
class Search:
    """What ends a motion on its way: an input that is `value`, the controller's `variable`, which the program calls `name`.

    The register `flag` becomes 1 then; the register `depth`, if it isn't empty, how far the frame has come [0.01 mm].
    """

    variable: str
    value: float
    name: str
    flag: str = ""
    depth: str = ""


@frozen(eq=False)
class JointMove(MotionHead):
    """Straight in joint space."""

    origin: Origin
    goal: JointGoal | JointDelta | PoseGoal
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None
    search: Search | None = None

    @property
    def goals(self) -> tuple[JointGoal | JointDelta | PoseGoal]:
        """The one goal."""
        return (self.goal,)


@frozen(eq=False)
class AvoidMove(MotionHead):
    """In joint space to the goal by a way that keeps clear of all that is around: straight where that is free, else a natural cubic
    spline, as that of a SplineMove, through way-points that the planner finds.
    """

    origin: Origin
    goal: JointGoal | PoseGoal
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None

    @property
    def goals(self) -> tuple[JointGoal | PoseGoal]:
        """The one goal."""
        return (self.goal,)


@frozen(eq=False)
class LineMove(MotionHead):
    """The moving frame goes straight, turning about one fixed axis, the short way."""

    leads_frame = True
    origin: Origin
    goal: PoseGoal | PoseDelta
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None
    search: Search | None = None

    @property
    def goals(self) -> tuple[PoseGoal | PoseDelta]:
        """The one goal."""
        return (self.goal,)


@frozen(eq=False)
class ArcMove(MotionHead):
    """The moving frame's origin goes along the circle through where it stands, `via` (3,) [m, in {B}] and the goal; it
    turns about one fixed axis, the short way, in step with the arc.
    """

    leads_frame = True
    origin: Origin
    via: Array
    goal: PoseGoal
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None

    @property
    def goals(self) -> tuple[PoseGoal]:
        """The one goal."""
        return (self.goal,)

    @property
    def besides(self) -> tuple[Array]:
        """The via point."""
        return (self.via,)


@frozen(eq=False)
class PoseSplineMove(MotionHead):
    """One C2 curve of the moving frame from where it stands through all way-points, which have one `flange_from_moving`.

    Positions and unit quaternions (each with the sign nearer to the one before) are natural cubic splines over
    u, the quaternions normalised. u grows from way-point to way-point by the root of the squares of the distance and of
    `TURN_CHORD` times the angle; neighbours of which it would grow by 1 um or less count once.
    """

    leads_frame = True
    origin: Origin
    waypoints: tuple[PoseGoal, ...]
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None

    @property
    def goals(self) -> tuple[PoseGoal, ...]:
        """The way-points."""
        return self.waypoints


TURN_CHORD = 0.1
"""How much of a spline's parameter [m] a turn of 1 rad between two way-points takes."""


@frozen(eq=False)
class SplineMove(MotionHead):
    """A natural cubic spline in joint space from where the robot stands through all way-points,
    over the chord length in joint space; equal neighbours count once.
    """

    origin: Origin
    waypoints: tuple[JointGoal | PoseGoal, ...]
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None

    @property
    def goals(self) -> tuple[JointGoal | PoseGoal, ...]:
        """The way-points."""
        return self.waypoints


@frozen(eq=False)
class Timetable:
    """Where all joints shall be at which times, and how fast.

    Between two rows each joint goes along the quintic polynomial that has the positions, velocities and accelerations of both, where these are given; the cubic
    polynomial with both velocities, where these are given alone; else all rows are joined by the one cubic spline in time with continuous acceleration and no velocity at both ends.

    Attributes:
        times: (k,) since the start of the motion [s], strictly increasing. The first may be 0: that row says where the motion begins.
            Otherwise it begins where the robot stands, without velocity and acceleration.
        positions: (k, n) [rad or m].
        velocities: (k, n) [per s], or None for all rows. None at the last row.
        accelerations: (k, n) [per s^2], or None for all rows; only with velocities.
    """

    times: Array
    positions: Array
    velocities: Array | None = None
    accelerations: Array | None = None

    @property
    def begins(self) -> bool:
        """True if the first row is the start, at time 0."""
        return bool(self.times[0] == 0.0)

    def stretched(self, factor: float) -> Timetable:
        """Return the same way with all times times a factor."""
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
    """All joints along a timetable, from where the robot stands to rest at its last row.

    Attributes:
        origin: the command.
        table: the rows as they are written.
        within: (n,) how far each joint may be from the path of the table at the same time [rad or m].
        stretch: all times are multiplied by it.
        timing: `duration` is the last time, stretched.
        profile: none: the table says how fast the joints go.
        tolerance: none: `within` says it.
        blend: none: the motion ends at rest.
        file: the file that has the table, as the program names it; empty if the rows stand in the program.
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

    @property
    def asked(self) -> Timetable:
        """The table with its times stretched."""
        return self.table.stretched(self.stretch)

    @property
    def goals(self) -> tuple[()]:
        """None: the table has its positions in one array."""
        return ()

    @property
    def end(self) -> JointGoal:
        """The last row."""
        return JointGoal(self.table.positions[-1])

    @property
    def besides(self) -> tuple[Array | None, ...]:
        """The table, how near to it the joints stay, and by what its times are stretched."""
        table = self.table
        stretch = np.array(self.stretch)
        return table.times, table.positions, table.velocities, table.accelerations, self.within, stretch

    @property
    def waypoints(self) -> tuple[JointGoal, ...]:
        """The positions of all rows behind the start."""
        return tuple(JointGoal(q) for q in self.table.positions[int(self.table.begins) :])


@frozen
class Signal:
    """An input or output: its name in the program, and the controller's variable; of a group the variables of its bits, the lowest first."""

    name: str
    variable: str

    @property
    def bits(self) -> tuple[Signal, ...]:
        """The single signals: itself, or the bits of a group, which are called JOB.0, JOB.1 and so on."""
        variables = bits_of(self.variable)
        if len(variables) == 1:
            return (self,)
        return tuple(Signal(f"{self.name}.{place}", one) for place, one in enumerate(variables))


@frozen
class Dwell:
    """The robot stands still for `duration` [s]."""

    origin: Origin
    duration: float


@frozen
class SetOutput:
    """An output takes a value when the motion before has ended."""

    origin: Origin
    output: Signal
    value: float


@frozen
class WaitInput:
    """The robot stands until an input has a value; an error after `timeout` [s] (None: never)."""

    origin: Origin
    input: Signal
    value: float
    timeout: float | None


@frozen
class WaitUntil:
    """The robot stands until a condition holds whose inputs are all read once at each look; an error after `timeout` [s] (None: never)."""

    origin: Origin
    condition: Value
    timeout: float | None


@frozen
class Hold:
    """The robot stands until the operator goes on, with a number for a `register` if that isn't empty: `text` is the question."""

    origin: Origin
    text: str
    register: str = ""


@frozen
class Say:
    """The operator is told a text, and the program goes on; `{N}` in it stands for what the register N holds."""

    origin: Origin
    text: str


@frozen
class When:
    """The steps up to the next Else or EndWhen of the same depth are done if a condition holds.

    With `again` it is decided with what the WHEN has read in whose second way it stands first: a CASE reads its inputs once. With a time `within` [s] the robot stands until the
    condition holds, or until the time is over.
    """

    origin: Origin
    condition: Value
    again: bool = False
    within: float | None = None


@frozen
class Else:
    """The steps from here on are done if the condition of the When doesn't hold."""

    origin: Origin


@frozen
class EndWhen:
    """Both ways meet here, at the same joint positions."""

    origin: Origin


@frozen
class Finish:
    """The program ends here, at rest: well, or as a fault whose reason is `text` if it `fails`. No step follows in its way."""

    origin: Origin
    fails: bool = False
    text: str = ""


@frozen
class Loop:
    """The steps from here to the EndLoop of the same depth are done again and again: pass after pass, each from where the first one begins."""

    origin: Origin


@frozen
class NextPass:
    """The innermost loop begins anew: the robot stands, and all is, as at its first pass. No step follows in its way."""

    origin: Origin


@frozen
class Exit:
    """The innermost loop is left: the program goes on behind it. No step follows in its way."""

    origin: Origin


@frozen
class EndLoop:
    """All Exits of a loop meet here, at the same joint positions."""

    origin: Origin


@frozen
class Assign:
    """A register, or an output, takes a value that is computed when the robot stands."""

    origin: Origin
    target: str | Signal
    value: Value


@frozen
class Output:
    """A declared output, and the value that it takes at any stop, hold or fault (None: it stays as it is). `step` is what one step of an analogue one is; values are in steps."""

    signal: Signal
    safe: float | None
    step: float | None = field(default=None, compare=False)


@frozen
class Stop:
    """The end of the program."""

    origin: Origin


@frozen
class Gap:
    """A command with errors: what it does, and where the robot stands behind it, isn't known."""


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
class Program:
    """A checked program: where the robot stands at first, and what it does.

    `start` is (n,) in rad (m), within the joint limits. `cell` are the surroundings that a CELL line names. A program with
    a Gap has errors: it is planned for the sake of further findings, and never emitted. `is_cut` is True if loops and calls were carried out in
    part only, because there are errors or only a first look was wanted; then there is a Gap as well. `cells` are given with a part of another program: the cell as it is
    during each motion there, by its step here. `watches` are the inputs that hold a motion.
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


def searches_of(program: Program) -> tuple[Searched, ...]:
    """Return the motions of a program that an input ends, in order."""
    return tuple(
        Searched(number, one.variable, one.value, one.name, one.flag, one.depth)
        for number, step in enumerate(program.steps)
        if isinstance(step, JointMove | LineMove) and (one := step.search) is not None
    )
