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
    """Nothing was done, and why; what to do about it, and the code of the finding that it is, if it is one."""

    ok: Literal[False] = False
    error: str
    help: str | None = None
    code: str | None = None


class Done(Reply):
    """It was done."""


class Taken(Reply):
    """An order was taken; in which state it found the robot. That it is carried out by now isn't said."""

    state: State


class Joint(Message):
    """Where a joint is: its actual position in `unit`, deg or mm; null where it isn't known yet."""

    name: str
    position: float | None
    unit: str


class Command(Message):
    """What is executed, and its line in the program."""

    title: str
    line: int


class Status(Reply):
    """How it is going."""

    program: str
    """What is under way, else what the process is for."""
    robot: str
    controller: str
    """Its address, HOST:PORT."""
    state: State
    why: str
    command: Command | None
    done: float
    """How far the program is [s]."""
    left: float
    """What is to go at the present override [s]."""
    override: float
    """Percent of the programmed speed."""
    joints: tuple[Joint, ...]
    waiting: int
    """Orders that weren't looked at yet."""
    pid: int
    since: str
    """When it began, ISO 8601."""
    owner: str | None = None
    """Who may move the robot."""
    clients: tuple[str, ...] = ()
    """Who is attached."""
    cell: str | None = None
    """The cell.toml that motions keep to."""
    log: str | None = None
    """Where motions are logged; null: nowhere yet."""
    log_lost: str = ""
    """What has happened to that file; empty: it is there."""
    asks: Question | None = None
    """What a HOLD asks the operator for; null: nothing."""
    wants: ValuesWanted | None = None
    """Which values the program takes from outside; null: none."""


class Filled(Reply):
    """The values are in their registers as soon as the program looks, within 20 ms: which ones, as integers."""

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
    """Whether the process is there to serve others (`yarc serve`)."""
    checked: int
    """How many things were looked at on the controller when the process began."""
    folder: str
    status: Status


class Place(Reply):
    """Where the robot is commanded to stand: exactly, and as the pose of a frame in another."""

    joints: Joints
    exact: tuple[float, ...]
    """The same in the order of the joints, unrounded [rad or m]."""
    pose: tuple[tuple[float, ...], ...] | None
    """(4, 4) base_from_moving [m]; null where a name means nothing."""
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
    """A motor as it was heard of last: bits of its status that are set, by their names; what keeps it from moving, empty if nothing does; and its following
    error [counts], null if it isn't known.
    """

    number: int
    closed_loop: bool
    homed: bool
    trouble: str
    flags: tuple[str, ...]
    following: float | None


class Health(Reply):
    """How motors, link and buffer are, as they were heard of last. `following` is how far each joint is behind its command [deg or mm]; `reply_s` how long the
    last reply took, `slowest_s` the slowest since the controller was looked at; `ahead` how many lines the controller has in its buffer, null if nothing is streamed;
    `guard` is true if the guard PLC was tried and found at work.
    """

    motors: tuple[MotorHealth, ...]
    following: Joints | None
    reply_s: float
    slowest_s: float
    silence_s: float
    """For how long the computer may be silent before its controller holds."""
    ahead: int | None
    guard: bool
    link: str = ""
    """Why there is no connection to the controller; empty: there is one."""


class Value(Reply):
    """The value of an input or output; null where the name means none."""

    value: float | None
    findings: tuple[Finding, ...]


class NamedSignal(Message):
    """An input or output: its name, the controller's variable, and its value; null where that isn't known now."""

    name: str
    variable: str
    value: float | None


class Surroundings(Reply):
    """What is around the robot. `robot` is the folder of its robot.toml; `cell` is the file of the cell of the program that was run last, else that of the session; `fixed` says why `input` can't set an input, and is empty where it can."""

    robot: str
    cell: str | None
    inputs: tuple[NamedSignal, ...]
    outputs: tuple[NamedSignal, ...]
    fixed: str


class PartPlace(Message):
    """Where a part of the cell is."""

    name: str
    held: str | None
    """The output whose gripper holds it; empty for one that hangs on the flange for good; null: it lies."""
    sure: bool
    """false: it may be here, or elsewhere."""
    pose: tuple[tuple[float, ...], ...]
    """(4, 4) base_from_part [m]; of a part that is held, flange_from_part."""


class Parts(Reply):
    """Where the parts of the session's cell are."""

    parts: tuple[PartPlace, ...]
    moved: bool
    """false: nothing has moved them, and they are where the cell's file has them."""
    doubt: str | None
    """Why nobody knows where they are; null: it is known."""
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

    `base`, `flange` and `tool` are links of its URDF: {B}, {FLANGE} and {TCP} (the flange if it has no {TCP}).
    """

    name: str
    controller: str = ""
    urdf: str
    """Its text, with meshes as URIs of files on this computer. Frames and mounted tools of robot.toml are links on the flange; joints that aren't the robot's axes are fixed at zero."""
    base: str
    flange: str
    tool: str
    joints: tuple[ModelJoint, ...]
    findings: tuple[Finding, ...]


class SceneShape(Message):
    """A shape around the origin of its pose, in m: a `box` has its edges as `size`; a `cylinder`, and the straight piece of a `capsule`, lie along z with their middle at the origin;
    a `mesh` is the URI of a file on this computer, whose coordinates count `scale`; a `half-space` is all that lies above the plane z = 0.
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
    """Of a zone: to stay inside, to stay outside, to go slowly inside, to keep the joints in a window inside."""
    speed: float | None
    """Of a slow zone [mm/s]."""
    sure: bool
    """false: a part that may be here, or elsewhere."""
    carried: bool
    """true: the robot carries it."""
    frame: str
    """The link of the URDF in which the pose is told: {B}, or {FLANGE} for what the robot carries."""
    pose: tuple[tuple[float, ...], ...]
    """(4, 4) frame_from_item [m]."""
    shape: SceneShape


class Scene(Reply):
    """What is around the robot: of the cell of the program that was run last, else of the session's."""

    version: str
    """Another one if anything else here is another one."""
    cell: str | None
    """The file of the cell; null: there is none."""
    items: tuple[SceneItem, ...]
    notes: tuple[str, ...]
    """What can't be shown, and why."""
    doubt: str | None
    """Why nobody knows where the parts are; null: it is known."""


class Declarations(Reply):
    """The declarations of the session as they were written, and how many commands were carried out."""

    declarations: tuple[str, ...]
    count: int


class Adopted(Reply):
    """Whether declarations hold from now on."""

    holds: bool
    findings: tuple[Finding, ...]


class Peak(Message):
    """How much of a limit is used at most (1: all of it), and by which joint or motor; empty where nothing moves."""

    name: str
    share: float


class Peaks(Message):
    """How much of the limits a motion uses at most."""

    velocity: Peak
    acceleration: Peak
    jerk: Peak | None
    """Null where the program lets it be any."""
    motor_velocity: Peak


class PathBound(Message):
    """How far the real path is from the programmed one at most, as proved."""

    position_mm: float
    angle_deg: float


class ClearanceBound(Message):
    """How far bodies stay apart at least, as proved; which ones, if they come near at all."""

    distance_mm: float
    first: str
    second: str


class MotionOffered(Message):
    """One motion of an offer: its index and name, how long it takes, which of the solutions of a pose it goes to, what was proved of it."""

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
    """How long something takes. Motions and dwells take a known time, along the longest and the shortest ways of a WHEN; what waits for an input or the
    operator is counted, along the ways with the most and the fewest of them.
    """

    duration_s: float
    duration_at_least_s: float
    waits: int
    waits_at_least: int
    loops: bool = False
    """True if how often its loops are gone through is known only when it runs: the longest time counts each once."""


class OfferDescribed(Message):
    """What would be done, if the owner says `go`."""

    number: int
    text: str
    title: str
    duration_s: float
    takes: Takes
    moves: bool
    """False where there are only declarations, which hold from then on."""
    start: Joints
    end: Joints
    motions: tuple[MotionOffered, ...]
    parts: tuple[str, ...]
    """What its SETs do to parts of the cell, in their order: `takes BOX 3`, `puts down BOX 3`, `removes BOX 3`."""
    course: Course


class Offered(Reply):
    """What a text would do; null where a finding forbids it, or where there is nothing to do."""

    offer: OfferDescribed | None
    findings: tuple[Finding, ...]


class ProgramCommand(Message):
    """A motion of a program, and when it is executed [s]; where ways part, at the latest."""

    title: str
    index: str
    begins_s: float
    ends_s: float
    line: int


class ProgramDescribed(Message):
    """A program that can be run.

    `duration_s` is the known time along the longest ways. `offset_s` and `rest_s` are where what is run first begins, and how long it takes; `steps` is how many commands are carried out one by one, 0 where they aren't.
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
    """Whether it waits or decides on the way, so that which commands are executed isn't known before."""
    not_looped: str
    """Why it can't be carried out again and again; empty: it can."""
    first: str
    """The index of the command that is run first."""
    tools: tuple[str, ...] | None
    """The tools that are on the flange where what is run begins, of a cell with tools that are changed; null: the cell has none."""


class Loaded(Reply):
    """A program that was compiled and proved, or judged; null where an error forbids to run it."""

    program: ProgramDescribed | None
    findings: tuple[Finding, ...]


class Way(Reply):
    """What lies between the robot and a program's start: how far it is off (empty: it stands there), and the slow motion that leads there."""

    text: str
    duration_s: float | None
    """Null: none is needed, or there is none."""
    title: str
    """Of the motion's command."""
    end: Joints
    findings: tuple[Finding, ...]
    zone: str
    """The start zone of the cell in which the robot stands: `run` goes to the start by itself there; empty: it stands in none."""


class Recovery(Reply):
    """The proved way from where the robot stands to a program: to its start, or to the nearest place at which it may begin."""

    place: str | None
    """Of the command to begin with then; empty: the program's start. Null: no motion is proved, and `findings` say why."""
    title: str
    """`the start`, or the command's index and name."""
    line: int
    offer: OfferDescribed | None
    """The motion, which `go` carries out; null if the robot stands there, or if no motion is proved."""
    share: float
    """How fast the slowest joint moves, as a share of its limits."""
    assumed: tuple[str, ...]
    """Parts of which nobody has said where they are: they are taken to be where the program has them at that place."""
    refused: tuple[Finding, ...]
    """Why it isn't the start, if it isn't."""
    findings: tuple[Finding, ...]


class SourcePlace(Message):
    """Where a command stands in its source, as far as the source is known; else `note` says why not. Of a command in a module, the line is the one that calls, and `note` the module's."""

    file: str
    line: int
    column: int
    end_column: int
    text: str
    note: str


class RestingPlace(Message):
    """In which command a robot rests on its path, and how far into the program [s]."""

    title: str
    done_s: float


class Ended(Reply):
    """How something has ended. `joints` is null where nobody knows."""

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
    """Whether the robot was on the way to the program's start."""
    passes: int = 1
    where: SourcePlace | None = None
    """Where the command stands that a fault is about."""
    resting: RestingPlace | None = None
    """Where on its path the robot rests, if it does."""
    is_motion: bool = True
    """Whether what was executed is a motion of the program."""
    go_on: str | None = None
    """The command to begin with (--from) to go on; empty: the first one; null: nobody knows."""


class LogTold(Message):
    """Where motions were logged, and what is wrong with the log; `lost`: nothing of it is left."""

    path: str
    problem: str
    help: str
    lost: bool


class Released(Reply):
    """The robot is nobody's; what became of the log of what was moved meanwhile, if there was one."""

    log: LogTold | None


class Saved(Reply):
    """The session as a program that does the same."""

    text: str


class Looked(Reply):
    """Everything was looked at on the controller: how many things, and what isn't as it must be."""

    checked: int
    wrong: tuple[str, ...]


class Serviced(Reply):
    """Loops were closed or opened: `what` isn't as it must be, empty if all is well; `wrong` still keeps the robot from moving."""

    what: str
    wrong: tuple[str, ...]


class MotorSearch(Message):
    """The controller's own home search of a motor: the joint that it moves, how fast (with its sign) [unit/s], and how long it may take [s]; `refused` says why it isn't done here."""

    motor: int
    joint: str
    unit: str
    speed: float
    longest_s: float
    refused: str
    homed: bool


class HomeSearches(Reply):
    """The home searches of all motors. None of them is proved, and no zone or obstacle is watched meanwhile."""

    searches: tuple[MotorSearch, ...]


class Comparison(Message):
    """One thing on the controller: what was found, what is wanted, `ok`, `warning` or `error`, and what to do about it."""

    name: str
    about: str
    found: str
    wanted: str
    verdict: Literal["ok", "warning", "error"]
    help: str


class SettingsCompared(Reply):
    """What was found on the controller, and the settings that the robot needs: as many lines, and their SHA-256."""

    things: tuple[Comparison, ...]
    lines: int
    sha256: str


class SettingsSent(Reply):
    """How many lines of the settings the controller has taken, of how many; what ended it before, empty if nothing did; and what isn't as it must be now."""

    sent: int
    of: int
    what: str
    help: str
    wrong: tuple[str, ...]


class Wanted(Reply):
    """What is wanted of a live motion is done, `lag_s` later."""

    lag_s: float
    behind: Joints | None
    """How far what is streamed is behind a master."""
    why: str
    """What keeps the robot from what is wanted; empty: nothing does."""
