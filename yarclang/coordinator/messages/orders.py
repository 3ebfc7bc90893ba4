"""Orders and questions of a client. Every client may order stops and holds, which are executed before all
other orders. Only the robot's owner may give orders that move the robot.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Generic, Literal, TypeVar, get_args

from pydantic import Field, JsonValue

from yarclang.coordinator.messages import courses, replies
from yarclang.coordinator.messages.message import VERSION, Message, Number
from yarclang.coordinator.messages.replies import Reply

R = TypeVar("R", bound=Reply)


class Order(Message, Generic[R]):
    """A request to do or to report something. Each type of order has a type of reply of its own. Any order
    may also be answered by `Denied`.
    """

    answer: ClassVar[type[Reply]] = Reply

    if not TYPE_CHECKING:

        def __class_getitem__(cls, answer: Any) -> Any:
            """Return a plain alias. Otherwise pydantic would create a model for each type of reply, and
            search all modules for the definition of this model at every start.
            """
            return Generic.__class_getitem__.__func__(cls, answer)

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        """Store the type of the reply."""
        for base in cls.__dict__.get("__orig_bases__", ()):
            (found,) = get_args(base)
            if not isinstance(found, TypeVar):
                cls.answer = found


Percent = Annotated[float, Field(ge=1.0, le=100.0, description="a number from 1 to 100")]
Name = Annotated[str, Field(max_length=200, description="a name")]
Line = Annotated[str, Field(description="a text")]


class Hello(Order[replies.Welcome]):
    """Become a client. This is the first order of each connection that stays open. Other clients see its
    `name`; a number is added if the name is taken.
    """

    order: Literal["hello"] = "hello"
    version: Annotated[int, Field(description="the version of the protocol")] = VERSION
    name: Name = "client"


class AskStatus(Order[replies.Status]):
    """Ask for the state of the robot and its run."""

    order: Literal["status"] = "status"


class Hold(Order[replies.Taken]):
    """Come to rest on the path, ready to continue."""

    order: Literal["hold"] = "hold"


class Resume(Order[replies.Taken]):
    """Continue after a hold, at a HOLD of the program, or with the next command. `value` is the answer to a
    HOLD's question.
    """

    order: Literal["resume"] = "resume"
    value: Annotated[int | None, Field(description="an integer, or null")] = None


class Step(Order[replies.Taken]):
    """Continue with the next command."""

    order: Literal["step"] = "step"


class Stop(Order[replies.Taken]):
    """Come to rest on the path, and end the run."""

    order: Literal["stop"] = "stop"


class Abort(Order[replies.Taken]):
    """Stop each motor at once, off the path."""

    order: Literal["abort"] = "abort"


class Override(Order[replies.Taken]):
    """Set the override of the present motion and of all later ones."""

    order: Literal["override"] = "override"
    percent: Percent


class Listen(Order[replies.Done]):
    """Receive all events from now on. Positions are sent only if they are requested."""

    order: Literal["listen"] = "listen"
    positions: Annotated[bool, Field(description="true or false")] = False


class Own(Order[replies.Done]):
    """Become the owner of the robot. `shared`: other clients may also resume and change the override."""

    order: Literal["own"] = "own"
    shared: Annotated[bool, Field(description="true or false")] = False


class Give(Order[replies.Done]):
    """Hand the robot over to another client."""

    order: Literal["give"] = "give"
    to: Name


class Release(Order[replies.Released]):
    """Give up the robot. The reply contains the state of the log of its motions."""

    order: Literal["release"] = "release"


class Clear(Order[replies.Done]):
    """Inspect the controller after a fault. If everything is in order, motions are possible again."""

    order: Literal["clear"] = "clear"


class Look(Order[replies.Looked]):
    """Check all conditions on the controller that a motion needs; nothing moves."""

    order: Literal["look"] = "look"


class Connect(Order[replies.Done]):
    """Try at once to reconnect to the controller, without waiting for the next automatic attempt."""

    order: Literal["connect"] = "connect"


class Enable(Order[replies.Serviced]):
    """Close the loops of the motors that are open, one after the other, at rest. Each motor must stay in
    place. Afterwards everything is inspected.
    """

    order: Literal["enable"] = "enable"


class Disable(Order[replies.Serviced]):
    """Open the loops of all motors, at rest. Then only the brakes of the machine hold the robot. Without
    brakes, it may fall.
    """

    order: Literal["disable"] = "disable"


class AskHoming(Order[replies.HomeSearches]):
    """Ask what the controller's own home search of each motor would do."""

    order: Literal["homing"] = "homing"


class Home(Order[replies.Ended]):
    """Let the controller search the home position of motors, one after the other, as long as `keep` arrives
    every 0.2 s. The search isn't proved. The reply comes when the search has ended.
    """

    order: Literal["home"] = "home"
    motors: Annotated[
        tuple[Annotated[int, Field(ge=1, le=32)], ...],
        Field(min_length=1, max_length=32, description="a list of motors' numbers, in their order"),
    ]


class AskSettings(Order[replies.SettingsCompared]):
    """Compare the settings of the controller with those that the robot needs; nothing moves."""

    order: Literal["settings"] = "settings"


class SendSettings(Order[replies.SettingsSent]):
    """Send the settings that `yarc settings` prints to the controller. The robot must be at rest with all
    loops open.
    """

    order: Literal["send-settings"] = "send-settings"
    known: Annotated[str, Field(max_length=64, description="the `sha256` of the settings that were shown")]


class SaveSettings(Order[replies.Done]):
    """Let the controller store its settings permanently (SAVE), at rest."""

    order: Literal["save-settings"] = "save-settings"


class AskPlace(Order[replies.Place]):
    """Ask for the commanded position of the robot, and for the pose of a frame in another frame."""

    order: Literal["where"] = "where"
    base: Name = "{B}"
    moving: Name = "{TCP}"


class AskFrames(Order[replies.Frames]):
    """Ask for the named frames of the session, and their poses."""

    order: Literal["frames"] = "frames"


class AskHealth(Order[replies.Health]):
    """Ask for the last reported state of motors, connection and buffer. Possible during a motion, too."""

    order: Literal["health"] = "health"


class Read(Order[replies.Value]):
    """Ask for the value of an input or output that the session declares."""

    order: Literal["read"] = "read"
    name: Name


class SetOutput(Order[replies.Value]):
    """Set an output that the session declares, at once."""

    order: Literal["set"] = "set"
    name: Name
    value: Annotated[Number | Literal["ON", "OFF"], Field(description='a number, "ON" or "OFF"')]


class Fill(Order[replies.Filled]):
    """Send values for registers that a program takes from OUTSIDE. This is possible while the program waits
    for them. Either all values are accepted, or none.
    """

    order: Literal["fill"] = "fill"
    values: Annotated[dict[str, JsonValue], Field(description="object of integer by name")]
    """Values by the names of the registers."""
    number: Annotated[int | None, Field(description="the number of a question, or null")] = None
    """Number of the question that is answered (from `values_wanted`). If this question is no longer open, the
    order is refused. Null: the question that is open now.
    """


class SetInput(Order[replies.Value]):
    """Set an input of a robot that the coordinator simulates, at once, also while a program runs."""

    order: Literal["input"] = "input"
    name: Name
    value: Annotated[Number | Literal["ON", "OFF"], Field(description='a number, "ON" or "OFF"')]


class AskSurroundings(Order[replies.Surroundings]):
    """Ask for the robot's surroundings: the cell, its file, and inputs and outputs with their values. Values
    of a real controller are known only while nothing is in progress.
    """

    order: Literal["surroundings"] = "surroundings"


class AskParts(Order[replies.Parts]):
    """Ask for the places of the parts in the session's cell, or in another cell. If the parts of another cell
    haven't been moved, the list in the reply is empty.
    """

    order: Literal["parts"] = "parts"
    cell: Annotated[str | None, Field(description="path of a cell's file, or null for the session's")] = None


class AskModel(Order[replies.Model]):
    """Ask for the robot's description, for programs that draw it: its URDF with the files of its meshes, its
    joints and their limits.
    """

    order: Literal["model"] = "model"


class AskScene(Order[replies.Scene]):
    """Ask for the robot's surroundings, for programs that draw them: the bodies, zones and parts of its cell,
    and their present places. The event `scene_changed` reports a change.
    """

    order: Literal["scene"] = "scene"


class PlacePart(Order[replies.Parts]):
    """Declare where a part of the session's cell is, according to the user."""

    order: Literal["place-part"] = "place-part"
    part: Annotated[Name | None, Field(description="a name, or null for all (only with `at` `file`)")] = None
    at: Annotated[
        Literal["file", "frame", "gone"],
        Field(
            description="`file`: where the cell's file has it; `frame`: at `pose` in `frame`; `gone`: nowhere"
        ),
    ]
    frame: Annotated[Name, Field(description="a frame; that of a gripper: the gripper holds the part")] = (
        "{B}"
    )
    pose: Annotated[
        tuple[Number, ...],
        Field(min_length=6, max_length=6, description="six numbers: x y z in mm, roll pitch yaw in deg"),
    ] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class AskDeclarations(Order[replies.Declarations]):
    """Ask for the declarations of the session."""

    order: Literal["declarations"] = "declarations"


class Adopt(Order[replies.Adopted]):
    """Replace all declarations of the session by the given ones."""

    order: Literal["adopt"] = "adopt"
    declarations: Annotated[tuple[str, ...], Field(description="a list of texts")]


class Offer(Order[replies.Offered]):
    """Plan and prove a line, a block or several lines from the robot's position. Nothing moves."""

    order: Literal["offer"] = "offer"
    text: Line


class OfferBack(Order[replies.Offered]):
    """Plan and prove a motion back along the path of the last motion. Nothing moves."""

    order: Literal["offer-back"] = "offer-back"


class OfferRecovery(Order[replies.Recovery]):
    """Plan and prove a motion from the robot's position to a loaded program: to its start, otherwise to the
    nearest place at which it can begin. If the program was loaded with `first`, only this command is tried.
    Nothing moves.
    """

    order: Literal["offer-recovery"] = "offer-recovery"
    program: Annotated[int, Field(description="the number of a program")]


class Go(Order[replies.Ended]):
    """Carry an offer out. The reply comes when the motion has ended."""

    order: Literal["go"] = "go"
    offer: Annotated[int, Field(description="the number of an offer")]
    held: Annotated[bool, Field(description="true or false")] = False
    """True: move only as long as `keep` arrives every 0.2 s. Otherwise the robot comes to rest on the path,
    until `resume`.
    """


class Keep(Order[replies.Done]):
    """Confirm a motion that was begun by `go` with `held`. The motion continues as long as this order arrives
    at least every 0.2 s.
    """

    order: Literal["keep"] = "keep"


class Load(Order[replies.Loaded]):
    """Compile and prove a program, or verify a compiled program, so that it can be run. Nothing moves."""

    order: Literal["load"] = "load"
    file: Annotated[str, Field(description="the path of a file")]
    """Path of the program's file. If `text` is given, this is only the program's name."""
    text: Annotated[str | None, Field(description="a text, or null")] = None
    """Text of the program, used instead of the text of the file."""
    first: Annotated[str | None, Field(description="the index of a command, or null")] = None
    """Index of the command at which the run begins."""
    by_steps: Annotated[bool, Field(description="true or false")] = False
    here: Annotated[bool, Field(description="true or false")] = False
    """True: a program without START begins at the robot's position."""
    start: Annotated[tuple[Number, ...] | None, Field(description="a list of numbers, or null")] = None
    """Joint positions at the program's start [deg or mm]."""
    tolerance: Annotated[
        tuple[Number, ...] | None, Field(max_length=2, description="one or two numbers, or null")
    ] = None
    """Tolerance of the path [mm], and of the tool's orientation [deg]."""
    tm: Annotated[Number | None, Field(description="a number, or null")] = None
    """The longest segment time [ms]."""
    cell: Annotated[str | None, Field(description="the path of a file, or null")] = None
    """For a compiled program: file of the cell, used instead of the program's own cell."""
    source: Annotated[str | None, Field(description="the path of a file, or null")] = None
    """For a compiled program: file of the source against which it is verified; null: the source file in the
    same folder.
    """
    approach: Annotated[bool, Field(description="true or false")] = False
    """True to plan the motion to the program's start as well."""
    recover: Annotated[bool, Field(description="true or false")] = False
    """True for a program that is loaded only for `offer-recovery`. At the start of the program, the cell's
    parts are then assumed to be in the places that the cell's file gives.
    """


class AskWay(Order[replies.Way]):
    """Ask for the distance of the robot from the start of a loaded program, and for the slow motion to the
    start.
    """

    order: Literal["way"] = "way"
    program: Annotated[int, Field(description="the number of a program")]


class AskCourse(Order[courses.ProgramCourse]):
    """Ask for the robot's motion in a loaded program, and for the proved distances."""

    order: Literal["course"] = "course"
    program: Annotated[int, Field(description="the number of a program")]
    samples: Annotated[int, Field(ge=2, le=2000, description="an integer from 2 to 2000")] = 500
    """Number of joint positions in the reply."""


APPROACH_FIRST = "approach it first"
"""Remedy in the refusal of a run if the robot isn't at the program's start. User interfaces recognize this
text, and show a remedy of their own instead.
"""


class Run(Order[replies.Ended]):
    """Carry a loaded program out. The reply comes when the run has ended."""

    order: Literal["run"] = "run"
    program: Annotated[int, Field(description="the number of a program")]
    approach: Annotated[bool, Field(description="true or false")] = False
    """True to move slowly to the program's start first, if the robot isn't there."""
    times: Annotated[int | None, Field(ge=1, description="an integer from 1, or null")] = 1
    """Number of passes; null: until somebody stops the run."""
    unless_stopped: Annotated[bool, Field(description="true or false")] = False
    """True: the run doesn't begin if a stop was ordered since this client's last `own`. For clients that plan
    and run without a user.
    """


class Save(Order[replies.Saved]):
    """Return the session as a program with the same effect."""

    order: Literal["save"] = "save"
    folder: Annotated[str | None, Field(description="the path of a folder, or null")] = None
    """Folder for which the program is written: the file names in it become relative to this folder."""


class Steer(Order[replies.Done]):
    """Configure the next live motions, before the first target is sent."""

    order: Literal["steer"] = "steer"
    moving: Name = "{TCP}"
    """Frame of the live motions: twists move it, poses refer to it, and its speed is limited."""
    speed: Annotated[float | None, Field(gt=0.0, le=1e9, description="a positive number, or null")] = None
    """Largest speed of the frame `moving` [mm/s]; null: the robot's jog speed."""
    share: Annotated[float, Field(gt=0.0, le=1.0, description="a number above 0, up to 1")] = 1.0
    """Largest share of the joints' velocity limits that is used."""
    again: Annotated[bool, Field(description="true or false")] = True
    """True: a target after the end of a live motion begins another one. False: this order is needed before
    each live motion.
    """
    title: Name = "master"
    """Name of the motion."""


class Leave(Order[replies.Done]):
    """Bring the live motion of this client to rest at once, if there is one, because its user has gone."""

    order: Literal["leave"] = "leave"


KINDS: tuple[type[Order[Any]], ...] = (
    Hello,
    AskStatus,
    Hold,
    Resume,
    Step,
    Stop,
    Abort,
    Override,
    Listen,
    Own,
    Give,
    Release,
    Clear,
    Look,
    Connect,
    Enable,
    Disable,
    AskHoming,
    Home,
    AskSettings,
    SendSettings,
    SaveSettings,
    AskPlace,
    AskFrames,
    AskHealth,
    Read,
    SetOutput,
    Fill,
    SetInput,
    AskSurroundings,
    AskParts,
    AskModel,
    AskScene,
    PlacePart,
    AskDeclarations,
    Adopt,
    Offer,
    OfferBack,
    OfferRecovery,
    Go,
    Keep,
    Load,
    AskWay,
    AskCourse,
    Run,
    Save,
    Steer,
    Leave,
)
"""All orders, in the order of the documentation."""
