"""What a coordinator answers to an order. Each has `ok`, and `id` if the order had one."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.findings import Finding
from yarclang.coordinator.messages.message import Joints, Message
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


class Value(Reply):
    """The value of an input or output; null where the name means none."""

    value: float | None
    findings: tuple[Finding, ...]


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


class OfferDescribed(Message):
    """What would be done, if the owner says `go`."""

    number: int
    text: str
    title: str
    duration_s: float
    moves: bool
    """False where there are only declarations, which hold from then on."""
    start: Joints
    end: Joints
    motions: tuple[MotionOffered, ...]
    course: Course


class Offered(Reply):
    """What a text would do; null where a finding forbids it, or where there is nothing to do."""

    offer: OfferDescribed | None
    findings: tuple[Finding, ...]


class ProgramCommand(Message):
    """A command of a program, and when it is executed [s]."""

    title: str
    index: str
    begins_s: float
    ends_s: float
    line: int


class ProgramDescribed(Message):
    """A program that can be run.

    `offset_s` and `rest_s` are where what is run first begins, and how long it takes; `steps` is how many commands are carried out one by one, 0 where they aren't.
    """

    number: int
    name: str
    duration_s: float
    commands: tuple[ProgramCommand, ...]
    offset_s: float
    rest_s: float
    steps: int
    begins_within: bool
    guarded: bool
    by_legs: bool
    """Whether it waits or decides on the way, so that which commands are executed isn't known before."""
    not_looped: str
    """Why it can't be carried out again and again; empty: it can."""
    first: str
    """The index of the command that is run first."""


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


class SourcePlace(Message):
    """Where a command stands in its source, as far as the source is known; else `note` says why not."""

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


class Wanted(Reply):
    """What is wanted of a live motion is done, `lag_s` later."""

    lag_s: float
    behind: Joints | None
    """How far what is streamed is behind a master."""
    why: str
    """What keeps the robot from what is wanted; empty: nothing does."""
