"""Answers of a coordinator to orders. Each has `ok`, and `id` if the order had one."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.findings import Finding
from yarclang.coordinator.messages.message import Joints, Message, Question, ValuesWanted
from yarclang.runtime.state import State


class Reply(Message):
    """An order was taken."""

    ok: Literal[True] = True


class Denied(Message):
    """The order was denied: the reason, a remedy, and the code of the finding, if there is one."""

    ok: Literal[False] = False
    error: str
    help: str | None = None
    code: str | None = None


class Done(Reply):
    """The order was carried out."""


class Taken(Reply):
    """The order was accepted: the state of the robot at that time. It may not have been carried out yet."""

    state: State


class Joint(Message):
    """Actual position of a joint in `unit`, deg or mm; null if it isn't known yet."""

    name: str
    position: float | None
    unit: str


class Command(Message):
    """Command that is being executed, and its line in the program."""

    title: str
    line: int


class Status(Reply):
    """State of the robot and of its run."""

    program: str
    """Name of what is under way, otherwise of the process's purpose."""
    robot: str
    controller: str
    """Address of the controller, HOST:PORT."""
    state: State
    why: str
    command: Command | None
    done: float
    """Time of the program that has passed [s]."""
    left: float
    """Remaining time at the present override [s]."""
    override: float
    """Percent of the programmed speed."""
    joints: tuple[Joint, ...]
    waiting: int
    """Number of orders that wait to be handled."""
    pid: int
    since: str
    """Start time, ISO 8601."""
    owner: str | None = None
    """Client that may move the robot."""
    clients: tuple[str, ...] = ()
    """Names of the attached clients."""
    cell: str | None = None
    """cell.toml against which motions are checked."""
    log: str | None = None
    """File in which motions are logged; null: none yet."""
    log_lost: str = ""
    """Fault of that file; empty: none."""
    asks: Question | None = None
    """Question of a HOLD to the operator; null: none."""
    wants: ValuesWanted | None = None
    """Values that the program takes from outside now; null: none."""


class Filled(Reply):
    """The values were accepted, as integers; the program sees them in its registers within 20 ms."""

    values: dict[str, int]


class Welcome(Reply):
    """The caller is a client from now on, under this name."""

    version: int
    yarclang: str
    name: str
    fingerprint: str
    """Of the robot."""
    simulated: bool
    serves: bool
    """True if the process serves clients (`yarc serve`)."""
    checked: int
    """Number of checks on the controller at the start of the process."""
    folder: str
    status: Status


class Place(Reply):
    """Commanded position of the robot, exact, and as the pose of a frame in another."""

    joints: Joints
    exact: tuple[float, ...]
    """Joint positions in the order of the joints, unrounded [rad or m]."""
    pose: tuple[tuple[float, ...], ...] | None
    """(4, 4) base_from_moving [m]; null if a name is unknown."""
    findings: tuple[Finding, ...]


class NamedFrame(Message):
    """A frame, in braces: (4, 4) base_from_frame [m], or, with `on_flange`, flange_from_frame."""

    name: str
    on_flange: bool
    pose: tuple[tuple[float, ...], ...]


class Frames(Reply):
    """The frames that have a name in the session."""

    frames: tuple[NamedFrame, ...]


class MotorHealth(Message):
    """A motor's last reported state: names of the status bits that are set; the reason why it can't move,
    empty if it can; and its following error [counts], null if it isn't known.
    """

    number: int
    closed_loop: bool
    homed: bool
    trouble: str
    flags: tuple[str, ...]
    following: float | None


class Health(Reply):
    """Last reported state of motors, link and buffer. `following` is each joint's distance from its command
    [deg or mm]; `reply_s` how long the last reply took, `slowest_s` the slowest since the controller was
    looked at; `ahead` how many lines the controller has in its buffer, null if nothing is streamed; `guard`
    is true if the guard PLC was tried and found at work.
    """

    motors: tuple[MotorHealth, ...]
    following: Joints | None
    reply_s: float
    slowest_s: float
    silence_s: float
    """Longest silence of the computer before its controller holds [s]."""
    ahead: int | None
    guard: bool
    link: str = ""
    """Reason for a missing connection to the controller; empty: connected."""


class Value(Reply):
    """The value of an input or output; null if the name is unknown."""

    value: float | None
    findings: tuple[Finding, ...]


class NamedSignal(Message):
    """An input or output: its name, the controller's variable, and its value; null if the value isn't known
    now.
    """

    name: str
    variable: str
    value: float | None


class Surroundings(Reply):
    """The robot's surroundings. `robot` is the folder of its robot.toml; `cell` is the file of the cell of
    the program that was run last, else that of the session; `fixed` is the reason why `input` can't set an
    input, empty if it can.
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
    """Output whose gripper holds the part; empty for a part that is fixed to the flange; null: it isn't held.
    """
    sure: bool
    """false: the place isn't certain."""
    pose: tuple[tuple[float, ...], ...]
    """(4, 4) base_from_part [m]; of a part that is held, flange_from_part."""


class Parts(Reply):
    """Places of the parts of the session's cell."""

    parts: tuple[PartPlace, ...]
    moved: bool
    """false: nothing has moved the parts, and they are at the places of the cell's file."""
    doubt: str | None
    """Reason for which the places aren't known; null: they are known."""
    findings: tuple[Finding, ...]


class ModelJoint(Message):
    """A joint, with its limits per `unit` (deg or mm) and s; null: it turns without end."""

    name: str
    unit: str
    lower: float | None
    upper: float | None
    velocity: float
    acceleration: float


class Model(Reply):
    """The robot. `controller` is the kind of its controller, for people.

    `base`, `flange` and `tool` are links of its URDF: {B}, {FLANGE} and {TCP} (the flange if it has no
    {TCP}).
    """

    name: str
    controller: str = ""
    urdf: str
    """Its text, with meshes as URIs of files on this computer. Frames and mounted tools of robot.toml are
    links on the flange; joints that aren't the robot's axes are fixed at zero.
    """
    base: str
    flange: str
    tool: str
    joints: tuple[ModelJoint, ...]
    findings: tuple[Finding, ...]


class SceneShape(Message):
    """A shape around the origin of its pose, in m: a `box` has its edges as `size`; a `cylinder`, and the
    straight piece of a `capsule`, lie along z with their middle at the origin; a `mesh` is the URI of a file
    on this computer, whose coordinates count `scale`; a `half-space` is all that lies above the plane z = 0.
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
    """Rule of a zone: stay inside, stay outside, be slow inside, keep the joints in a window inside."""
    speed: float | None
    """Speed of a slow zone [mm/s]."""
    sure: bool
    """false: a part whose place isn't certain."""
    carried: bool
    """true: the robot carries it."""
    frame: str
    """Link of the URDF in which the pose is given: {B}, or {FLANGE} for carried bodies."""
    pose: tuple[tuple[float, ...], ...]
    """(4, 4) frame_from_item [m]."""
    shape: SceneShape


class Scene(Reply):
    """Surroundings of the robot: the cell of the program that was run last, otherwise the session's."""

    version: str
    """Changes with any other field."""
    cell: str | None
    """The file of the cell; null: there is none."""
    items: tuple[SceneItem, ...]
    notes: tuple[str, ...]
    """Items that can't be shown, with reasons."""
    doubt: str | None
    """Reason for which the places of parts aren't known; null: they are known."""


class Declarations(Reply):
    """The declarations of the session as they were written, and how many commands were carried out."""

    declarations: tuple[str, ...]
    count: int


class Adopted(Reply):
    """True if the declarations are in force from now on."""

    holds: bool
    findings: tuple[Finding, ...]


class Peak(Message):
    """Largest used share of a limit (1: all of it), and the joint or motor; empty if nothing moves."""

    name: str
    share: float


class Peaks(Message):
    """Largest used shares of the limits in a motion."""

    velocity: Peak
    acceleration: Peak
    jerk: Peak | None
    """Null if the program doesn't limit it."""
    motor_velocity: Peak


class PathBound(Message):
    """Proved bound of the distance between the real and the programmed path."""

    position_mm: float
    angle_deg: float


class ClearanceBound(Message):
    """Proved smallest distance between bodies, and their names, if they come near at all."""

    distance_mm: float
    first: str
    second: str


class MotionOffered(Message):
    """One motion of an offer: its index and name, its duration, the chosen solution of a pose, and the proved
    figures.
    """

    title: str
    seconds: float
    branch: str
    peaks: Peaks
    path: PathBound | None
    """Null for motions of joints, which have no programmed path in space."""
    clearance: ClearanceBound | None


class Course(Message):
    """A motion, thinned: joint positions [deg or mm], in the order of the robot's joints, at times [s]."""

    times: tuple[float, ...]
    joints: tuple[tuple[float, ...], ...]


class Takes(Message):
    """Duration. Motions and dwells take a known time, along the longest and the shortest ways of a WHEN;
    commands that wait for an input or the operator is counted, along the ways with the most and the fewest of
    them.
    """

    duration_s: float
    duration_at_least_s: float
    waits: int
    waits_at_least: int
    loops: bool = False
    """True if the number of passes of its loops is known only at run time: the longest time counts each loop
    once.
    """


class OfferDescribed(Message):
    """A planned and proved motion, which `go` of the owner starts."""

    number: int
    text: str
    title: str
    duration_s: float
    takes: Takes
    moves: bool
    """False if there are only declarations, which are in force after `go`."""
    start: Joints
    end: Joints
    motions: tuple[MotionOffered, ...]
    parts: tuple[str, ...]
    """Effects of its SETs on parts of the cell, in order: `takes BOX 3`, `puts down BOX 3`, `removes BOX 3`.
    """
    course: Course


class Offered(Reply):
    """Offer for a text; null if a finding forbids it, or if there is nothing to do."""

    offer: OfferDescribed | None
    findings: tuple[Finding, ...]


class ProgramCommand(Message):
    """A motion of a program, and its time [s]; after ways that part, the latest time."""

    title: str
    index: str
    begins_s: float
    ends_s: float
    line: int


class ProgramDescribed(Message):
    """A program that can be run.

    `duration_s` is the known time along the longest ways. `offset_s` and `rest_s` are where what is run first
    begins, and how long it takes; `steps` is how many commands are carried out one by one, 0 where they
    aren't.
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
    """True if the program waits or branches, so that the executed commands aren't known before."""
    not_looped: str
    """Reason for which the program can't be repeated; empty: it can."""
    first: str
    """Index of the first command of the run."""
    tools: tuple[str, ...] | None
    """Tools on the flange at the beginning of the run; null if the cell has no tools that are changed."""


class Loaded(Reply):
    """A program that was compiled and proved, or judged; null if an error forbids running it."""

    program: ProgramDescribed | None
    findings: tuple[Finding, ...]


class Way(Reply):
    """Distance of the robot from a program's start (empty: it stands there), and the slow motion that leads
    there.
    """

    text: str
    duration_s: float | None
    """Null: no motion is needed, or none is possible."""
    title: str
    """Index of the motion's command."""
    end: Joints
    findings: tuple[Finding, ...]
    zone: str
    """The start zone of the cell in which the robot stands: `run` goes to the start by itself there; empty:
    it stands in none.
    """


class Recovery(Reply):
    """The proved way from the robot's position to a program: to its start, or to the nearest place at which
    it may begin.
    """

    place: str | None
    """Index of the command to begin with afterwards; empty: the program's start. Null: no motion is proved,
    and `findings` give the reasons.
    """
    title: str
    """`the start`, or the command's index and name."""
    line: int
    offer: OfferDescribed | None
    """The motion, which `go` carries out; null if the robot stands there, or if no motion is proved."""
    share: float
    """Speed as a share of the joints' limits."""
    assumed: tuple[str, ...]
    """Parts with unconfirmed places: assumed to be as in the program at that place."""
    refused: tuple[Finding, ...]
    """Reason for which the place isn't the start, if it isn't."""
    findings: tuple[Finding, ...]


class SourcePlace(Message):
    """Place of a command in its source; if the source isn't known, `note` gives the reason. For a command in
    a module, the line is that of the CALL, and `note` names the module's line.
    """

    file: str
    line: int
    column: int
    end_column: int
    text: str
    note: str


class RestingPlace(Message):
    """Command in which the robot rests on its path, and the time in the program [s]."""

    title: str
    done_s: float


class Ended(Reply):
    """End of a run or motion. `joints` is null if the position isn't known."""

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
    """Place of the command that a fault is about."""
    resting: RestingPlace | None = None
    """Place on its path at which the robot rests, if it does."""
    is_motion: bool = True
    """True if the executed motion is one of the program."""
    go_on: str | None = None
    """Command with which to continue (--from); empty: the first one; null: not known."""


class LogTold(Message):
    """Log of the motions, and its fault, if it has one; `lost`: nothing of the log is left."""

    path: str
    problem: str
    help: str
    lost: bool


class Released(Reply):
    """The robot was released; the state of the log of its motions, if there was one."""

    log: LogTold | None


class Saved(Reply):
    """The session as a program that does the same."""

    text: str


class Looked(Reply):
    """Everything on the controller was checked: the number of checks, and those that failed."""

    checked: int
    wrong: tuple[str, ...]


class Serviced(Reply):
    """Loops were closed or opened. `what` failed, empty if nothing did; `wrong` lists what still keeps the
    robot from moving.
    """

    what: str
    wrong: tuple[str, ...]


class MotorSearch(Message):
    """The controller's own home search of a motor: the joint that it moves, its speed (with sign) [unit/s],
    and its longest duration [s]; `refused` is the reason why it isn't allowed here.
    """

    motor: int
    joint: str
    unit: str
    speed: float
    longest_s: float
    refused: str
    homed: bool


class HomeSearches(Reply):
    """The home searches of all motors. None is proved, and no zone or obstacle is watched meanwhile."""

    searches: tuple[MotorSearch, ...]


class Comparison(Message):
    """One check of the controller: what was found, what is needed, `ok`, `warning` or `error`, and the
    remedy.
    """

    name: str
    about: str
    found: str
    wanted: str
    verdict: Literal["ok", "warning", "error"]
    help: str


class SettingsCompared(Reply):
    """Comparison of the controller with the settings that the robot needs: the number of their lines, and
    their SHA-256.
    """

    things: tuple[Comparison, ...]
    lines: int
    sha256: str


class SettingsSent(Reply):
    """Number of settings lines that the controller has accepted, of all; the reason for an early end, empty
    if there was none; and the checks that fail now.
    """

    sent: int
    of: int
    what: str
    help: str
    wrong: tuple[str, ...]


class Wanted(Reply):
    """A target of a live motion is accepted; the robot follows `lag_s` later."""

    lag_s: float
    behind: Joints | None
    """Distance of each streamed joint to its master [deg or mm]."""
    why: str
    """Obstacle to the target; empty: none."""
