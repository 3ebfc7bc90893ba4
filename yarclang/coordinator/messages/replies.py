"""Replies of a coordinator to orders. Each reply has `ok`, and `id` if the order had one."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.findings import Finding
from yarclang.coordinator.messages.message import Joints, Message, Question, ValuesWanted
from yarclang.runtime.state import State


class Reply(Message):
    """Reply to an order that was accepted."""

    ok: Literal[True] = True


class Denied(Message):
    """Reply to an order that was denied: the reason, a remedy, and the code of the finding, if there is
    one.
    """

    ok: Literal[False] = False
    error: str
    help: str | None = None
    code: str | None = None


class Done(Reply):
    """Reply to an order that was carried out."""


class Taken(Reply):
    """Reply to an order that was accepted, with the state of the robot at that time. The order may not have
    been carried out yet.
    """

    state: State


class Joint(Message):
    """Actual position of a joint in `unit`, deg or mm; null if it isn't known yet."""

    name: str
    position: float | None
    unit: str


class Command(Message):
    """The command that is being executed, and its line in the program."""

    title: str
    line: int


class Status(Reply):
    """State of the robot and of its program."""

    program: str
    """Name of the program or motion in progress; if there is none, name of the process."""
    robot: str
    controller: str
    """Address of the controller, HOST:PORT."""
    state: State
    why: str
    command: Command | None
    done: float
    """Passed time of the program [s]."""
    left: float
    """Remaining time at the present override [s]."""
    override: float
    """Override [percent of the programmed speed]."""
    joints: tuple[Joint, ...]
    waiting: int
    """Number of orders that haven't been processed yet."""
    pid: int
    since: str
    """Start time of the coordinator's process, ISO 8601."""
    owner: str | None = None
    """Client that may move the robot."""
    clients: tuple[str, ...] = ()
    """Names of the attached clients."""
    cell: str | None = None
    """Path of the cell.toml with which motions are checked."""
    log: str | None = None
    """File in which motions are logged; null: there is none yet."""
    log_lost: str = ""
    """Error of the log file; empty: none."""
    asks: Question | None = None
    """Question of a HOLD to the operator; null: none."""
    wants: ValuesWanted | None = None
    """Values that the program accepts from outside now; null: none."""


class Filled(Reply):
    """The values were accepted, as integers. Within 20 ms they are in the program's registers."""

    values: dict[str, int]


class Welcome(Reply):
    """The caller is now a client with this name."""

    version: int
    yarclang: str
    name: str
    fingerprint: str
    """Fingerprint (hash) of the robot's description."""
    simulated: bool
    serves: bool
    """True if the process serves clients (`yarc serve`)."""
    checked: int
    """Number of checks that were made on the controller when the process started."""
    folder: str
    status: Status


class Place(Reply):
    """Commanded position of the robot: joint positions, and the pose of a frame in another frame."""

    joints: Joints
    exact: tuple[float, ...]
    """Joint positions in the order of the joints, unrounded [rad or m]."""
    pose: tuple[tuple[float, ...], ...] | None
    """Matrix (4, 4) base_from_moving, lengths in m; null if a name is unknown."""
    findings: tuple[Finding, ...]


class NamedFrame(Message):
    """A frame, with its name in braces, and its pose as a matrix (4, 4) with lengths in m. The pose is
    flange_from_frame if `on_flange` is true, otherwise base_from_frame.
    """

    name: str
    on_flange: bool
    pose: tuple[tuple[float, ...], ...]


class Frames(Reply):
    """The named frames of the session."""

    frames: tuple[NamedFrame, ...]


class MotorHealth(Message):
    """Last reported state of a motor: the names of the status bits that are set, the reason why the motor
    can't move (empty if it can), and its following error [counts] (null if not known).
    """

    number: int
    closed_loop: bool
    homed: bool
    trouble: str
    flags: tuple[str, ...]
    following: float | None


class Health(Reply):
    """Last reported state of motors, connection and buffer.

    `following` is the distance of each joint from its commanded position [deg or mm]. `reply_s` is the time
    that the controller took for its last reply. `slowest_s` is the longest such time since the controller was
    inspected. `ahead` is the number of lines in the controller's buffer, null if nothing is streamed. `guard`
    is true if the guard PLC was tested and works.
    """

    motors: tuple[MotorHealth, ...]
    following: Joints | None
    reply_s: float
    slowest_s: float
    silence_s: float
    """Longest silence of the computer that the controller accepts [s]. After a longer one, it holds the
    robot.
    """
    ahead: int | None
    guard: bool
    link: str = ""
    """Reason why there is no connection to the controller; empty: there is one."""


class Value(Reply):
    """The value of an input or output; null if the name is unknown."""

    value: float | None
    findings: tuple[Finding, ...]


class NamedSignal(Message):
    """An input or output: its name, the controller's variable, and its value; null if the value isn't
    known at present.
    """

    name: str
    variable: str
    value: float | None


class Surroundings(Reply):
    """The robot's surroundings. `robot` is the folder of its robot.toml. `cell` is the file of the cell: the
    cell of the program that was run last, otherwise the cell of the session. `fixed` is the reason why the
    order `input` can't set an input, empty if it can.
    """

    robot: str
    cell: str | None
    inputs: tuple[NamedSignal, ...]
    outputs: tuple[NamedSignal, ...]
    fixed: str


class PartPlace(Message):
    """Place of a part of the cell."""

    name: str
    held: str | None
    """Output of the gripper that holds the part. Empty: the part is fixed to the flange. Null: it isn't held.
    """
    sure: bool
    """False: the place isn't certain."""
    pose: tuple[tuple[float, ...], ...]
    """Matrix (4, 4) with lengths in m: flange_from_part if the part is held, otherwise base_from_part."""


class Parts(Reply):
    """Places of the parts of the session's cell."""

    parts: tuple[PartPlace, ...]
    moved: bool
    """False: nothing has moved the parts. They are in the places that the cell's file gives."""
    doubt: str | None
    """Reason why the places aren't known; null: they are known."""
    findings: tuple[Finding, ...]


class ModelJoint(Message):
    """A joint, with its limits in `unit` (deg or mm) and per s. `lower` and `upper` are null if the joint
    turns without limits.
    """

    name: str
    unit: str
    lower: float | None
    upper: float | None
    velocity: float
    acceleration: float


class Model(Reply):
    """The robot. `controller` is the kind of its controller, as text.

    `base`, `flange` and `tool` are links of its URDF: {B}, {FLANGE} and {TCP} (the flange if there is no
    {TCP}).
    """

    name: str
    controller: str = ""
    urdf: str
    """Text of the URDF. Meshes are URIs of files on this computer. Frames and mounted tools of robot.toml are
    links on the flange. Joints that the controller doesn't move are fixed at zero.
    """
    base: str
    flange: str
    tool: str
    joints: tuple[ModelJoint, ...]
    findings: tuple[Finding, ...]


class SceneShape(Message):
    """A shape relative to its pose, lengths in m. `size` has the edge lengths of a `box`. A `cylinder`, and
    the straight piece of a `capsule`, are along z with their middle at the origin. A `mesh` is the URI of a
    file on this computer, whose coordinates are multiplied by `scale`. A `half-space` is everything on the
    positive side of the plane z = 0.
    """

    type: Literal["box", "sphere", "cylinder", "capsule", "mesh", "half-space"]
    size: tuple[float, ...] | None = None
    radius: float | None = None
    length: float | None = None
    mesh: str | None = None
    scale: tuple[float, ...] | None = None


class SceneItem(Message):
    """A body of the cell, a zone or a part."""

    name: str
    kind: Literal["body", "zone", "part"]
    rule: Literal["allowed", "forbidden", "slow", "posture"] | None
    """Rule of a zone: stay inside, stay outside, be slow inside, or keep the joints within a range while
    inside.
    """
    speed: float | None
    """Speed of a slow zone [mm/s]."""
    sure: bool
    """False if this is a part whose place isn't certain."""
    carried: bool
    """True if the robot carries this body."""
    frame: str
    """Link of the URDF in which the pose is given: {B}, or {FLANGE} for carried bodies."""
    pose: tuple[tuple[float, ...], ...]
    """Matrix (4, 4) frame_from_item, lengths in m."""
    shape: SceneShape


class Scene(Reply):
    """Surroundings of the robot: the cell of the program that was run last, otherwise the cell of the
    session.
    """

    version: str
    """Value that changes when any other field changes."""
    cell: str | None
    """The file of the cell; null: there is none."""
    items: tuple[SceneItem, ...]
    notes: tuple[str, ...]
    """Items that can't be shown, with reasons."""
    doubt: str | None
    """Reason why the places of parts aren't known; null: they are known."""


class Declarations(Reply):
    """The declarations of the session as written, and the number of commands that were carried out."""

    declarations: tuple[str, ...]
    count: int


class Adopted(Reply):
    """True if the declarations are in effect now."""

    holds: bool
    findings: tuple[Finding, ...]


class Peak(Message):
    """The largest share of a limit that a motion uses (1 is the limit itself), and the name of the joint or
    motor (empty if nothing moves).
    """

    name: str
    share: float


class Peaks(Message):
    """The largest shares of the limits that a motion uses."""

    velocity: Peak
    acceleration: Peak
    jerk: Peak | None
    """Largest share of the jerk limits; null if the program doesn't limit the jerk."""
    motor_velocity: Peak


class PathBound(Message):
    """Proved bound on the distance between the executed and the programmed path."""

    position_mm: float
    angle_deg: float


class ClearanceBound(Message):
    """Proved smallest distance between bodies, and the names of the two bodies (empty if no bodies come near
    each other).
    """

    distance_mm: float
    first: str
    second: str


class MotionOffered(Message):
    """A motion of an offer: its index and name, its duration, the chosen solution for a pose, and the
    proved values.
    """

    title: str
    seconds: float
    branch: str
    peaks: Peaks
    path: PathBound | None
    """Bound on the deviation from the path; null for joint motions, which have no programmed path in space.
    """
    clearance: ClearanceBound | None


class Course(Message):
    """A motion at selected times [s]: joint positions [deg or mm], in the order of the robot's joints."""

    times: tuple[float, ...]
    joints: tuple[tuple[float, ...], ...]


class Takes(Message):
    """Duration of a program. The times are those of motions and dwells, along the longest and the shortest
    branches of each WHEN. `waits` has the number of commands that wait for an input or the operator, along
    the branches with the most and with the fewest such commands.
    """

    duration_s: float
    duration_at_least_s: float
    waits: int
    waits_at_least: int
    loops: bool = False
    """True if the number of passes of a loop is known only at run time. `duration_s` contains one
    pass of each such loop.
    """


class OfferDescribed(Message):
    """A planned and proved motion. It begins when the owner sends `go`."""

    number: int
    text: str
    title: str
    duration_s: float
    takes: Takes
    moves: bool
    """False if there are only declarations, which take effect with `go`."""
    start: Joints
    end: Joints
    motions: tuple[MotionOffered, ...]
    parts: tuple[str, ...]
    """Effects of the offer's SETs on parts of the cell, in order: `takes BOX 3`, `puts down BOX 3`,
    `removes BOX 3`.
    """
    course: Course


class Offered(Reply):
    """The offer for a text; null if a finding forbids it, or if the text contains nothing to do."""

    offer: OfferDescribed | None
    findings: tuple[Finding, ...]


class ProgramCommand(Message):
    """A motion of a program, and the times of its beginning and end [s]. If there are branches before the
    motion, these are the latest possible times.
    """

    title: str
    index: str
    begins_s: float
    ends_s: float
    line: int


class ProgramDescribed(Message):
    """A program that can be run.

    `duration_s` is the time of motions and dwells along the longest branches. `offset_s` is the time of the
    program at which the run begins, and `rest_s` the duration from there to the end. `steps` is the number of
    commands that are run one by one; 0 if they aren't run one by one.
    """

    number: int
    name: str
    duration_s: float
    takes: Takes
    commands: tuple[ProgramCommand, ...]
    offset_s: float
    rest_s: float
    rest_takes: Takes
    steps: int
    begins_within: bool
    guarded: bool
    by_legs: bool
    """True if the program waits or branches, so that the executed commands aren't known in advance."""
    not_looped: str
    """Reason why the program can't be repeated; empty: it can."""
    first: str
    """Index of the first command of the run."""
    tools: tuple[str, ...] | None
    """Tools on the flange at the beginning of the run; null if the robot doesn't change tools in this
    cell.
    """


class Loaded(Reply):
    """A program that was compiled and proved, or verified; null if an error forbids running it."""

    program: ProgramDescribed | None
    findings: tuple[Finding, ...]


class Way(Reply):
    """Distance of the robot from a program's start (empty: it is at the start), and the slow motion to the
    start.
    """

    text: str
    duration_s: float | None
    """Duration of the motion; null: no motion is needed, or none is possible."""
    title: str
    """Index of the motion's command."""
    end: Joints
    findings: tuple[Finding, ...]
    zone: str
    """Name of the start zone of the cell in which the robot stands; empty: it is in none. From a start zone,
    `run` moves to the start without a request.
    """


class Recovery(Reply):
    """The proved motion from the robot's position to a program: to its start, or to the nearest position at
    which the program can begin.
    """

    place: str | None
    """Index of the command at which the program can begin after the motion; empty: the program's start. Null:
    no motion is proved, and `findings` gives the reasons.
    """
    title: str
    """`the start`, or the command's index and name."""
    line: int
    offer: OfferDescribed | None
    """The motion, for `go`; null if the robot is already there, or if no motion is proved."""
    share: float
    """Speed of the motion as a share of the joints' speed limits."""
    assumed: tuple[str, ...]
    """Parts whose places aren't confirmed. The proof assumes that they are where the program assumes them at
    `place`.
    """
    refused: tuple[Finding, ...]
    """Reasons why the motion doesn't lead to the program's start; empty if it leads there."""
    findings: tuple[Finding, ...]


class SourcePlace(Message):
    """Place of a command in its source. If the source isn't known, `note` is the reason. For a command in a
    module, the line is that of the CALL, and `note` names the line in the module.
    """

    file: str
    line: int
    column: int
    end_column: int
    text: str
    note: str


class RestingPlace(Message):
    """Command on whose path the robot rests, and the time in the program [s]."""

    title: str
    done_s: float


class Ended(Reply):
    """End of a run or a motion. `joints` is null if the position isn't known."""

    well: bool
    what: str | None = None
    help: str | None = None
    code: str | None = None
    command: str | None = None
    done_s: float = 0.0
    joints: Joints | None = None
    state: State
    moved: bool = False
    on_the_way: bool = False
    """True if the robot was on its way to the program's start."""
    passes: int = 1
    where: SourcePlace | None = None
    """Place of the command that failed, in its source file."""
    resting: RestingPlace | None = None
    """Place on the path at which the robot rests; null if it isn't on the path."""
    is_motion: bool = True
    """True if the command that was being executed is a motion of the program, false if it is another command,
    such as a WAIT.
    """
    go_on: str | None = None
    """Command with which to continue (--from); empty: the first command; null: not known."""


class LogTold(Message):
    """The log of the motions, and its error, if any. `lost`: the whole log is lost."""

    path: str
    problem: str
    help: str
    lost: bool


class Released(Reply):
    """The robot was released. `log` is the state of the log of its motions, if there was one."""

    log: LogTold | None


class Saved(Reply):
    """The session as a program with the same effect."""

    text: str


class Looked(Reply):
    """The controller was inspected: the number of checks, and the checks that have failed."""

    checked: int
    wrong: tuple[str, ...]


class Serviced(Reply):
    """Result of closing or opening the motors' control loops. `what` says what has failed, empty if nothing
    has; `wrong` lists what still prevents the robot from moving.
    """

    what: str
    wrong: tuple[str, ...]


class MotorSearch(Message):
    """The controller's own home search of a motor: the joint that it moves, its speed (with sign) [unit/s],
    and its longest duration [s]. `refused` is the reason why it isn't allowed here.
    """

    motor: int
    joint: str
    unit: str
    speed: float
    longest_s: float
    refused: str
    homed: bool


class HomeSearches(Reply):
    """The home searches of all motors. They aren't proved, and zones and obstacles aren't monitored during a
    search.
    """

    searches: tuple[MotorSearch, ...]


class Comparison(Message):
    """One check of the controller: the actual value, the required value, the level `ok`, `warning` or
    `error`, and the remedy.
    """

    name: str
    about: str
    found: str
    wanted: str
    verdict: Literal["ok", "warning", "error"]
    help: str


class SettingsCompared(Reply):
    """Comparison of the controller with the settings that the robot needs; the number of settings lines, and
    their SHA-256.
    """

    things: tuple[Comparison, ...]
    lines: int
    sha256: str


class SettingsSent(Reply):
    """Result of sending the settings: the number of lines that the controller has accepted, and of all lines;
    the reason for an early end (empty if there was none); and the checks that fail now.
    """

    sent: int
    of: int
    what: str
    help: str
    wrong: tuple[str, ...]


class Wanted(Reply):
    """A target of a live motion was accepted. The robot follows it after `lag_s`."""

    lag_s: float
    behind: Joints | None
    """Distance of each joint from the master at the end of the streamed lines [deg or mm]."""
    why: str
    """Reason why the robot doesn't follow the target; empty if it does."""
