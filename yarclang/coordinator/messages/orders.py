"""What a client may order or ask. Stops and holds are for everybody, and overtake everything; what moves the robot is for its owner."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Generic, Literal, TypeVar

from pydantic import Field

from yarclang.coordinator.messages import replies
from yarclang.coordinator.messages.message import VERSION, Message, Number
from yarclang.coordinator.messages.replies import Reply

R = TypeVar("R", bound=Reply)


class Order(Message, Generic[R]):
    """Something to do, or to say; answered by a reply of its kind, or denied."""

    answer: ClassVar[type[Reply]] = Reply

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        """Remember the kind of the answer."""
        for one in cls.__mro__:
            found = one.__dict__.get("__pydantic_generic_metadata__", {}).get("args")
            if found:
                cls.answer = found[0]
                return


Percent = Annotated[float, Field(ge=1.0, le=100.0, description="a number from 1 to 100")]
Name = Annotated[str, Field(max_length=200, description="a name")]
Line = Annotated[str, Field(description="a text")]


class Hello(Order[replies.Welcome]):
    """Become a client: the first order of whoever stays. Others know it by `name`; where that is taken, a number is added."""

    order: Literal["hello"] = "hello"
    version: Annotated[int, Field(description="the version of the protocol")] = VERSION
    name: Name = "client"


class AskStatus(Order[replies.Status]):
    """How is it going?"""

    order: Literal["status"] = "status"


class Hold(Order[replies.Taken]):
    """Come to rest on the path, ready to go on."""

    order: Literal["hold"] = "hold"


class Resume(Order[replies.Taken]):
    """Go on: behind a hold, at a HOLD of the program, to the next step."""

    order: Literal["resume"] = "resume"


class Step(Order[replies.Taken]):
    """Go on to the next command."""

    order: Literal["step"] = "step"


class Stop(Order[replies.Taken]):
    """Come to rest on the path, and end what is under way."""

    order: Literal["stop"] = "stop"


class Abort(Order[replies.Taken]):
    """Each motor comes to rest at once, off the path."""

    order: Literal["abort"] = "abort"


class Override(Order[replies.Taken]):
    """Another pace, for what is under way and what comes."""

    order: Literal["override"] = "override"
    percent: Percent


class Listen(Order[replies.Done]):
    """Be told all events from now on; positions only if they are wanted."""

    order: Literal["listen"] = "listen"
    positions: Annotated[bool, Field(description="true or false")] = False


class Own(Order[replies.Done]):
    """Own the robot. `shared`: others may resume and change the pace as well."""

    order: Literal["own"] = "own"
    shared: Annotated[bool, Field(description="true or false")] = False


class Give(Order[replies.Done]):
    """Give the robot over to another client."""

    order: Literal["give"] = "give"
    to: Name


class Release(Order[replies.Released]):
    """Leave the robot to nobody; what became of the log of its motions is answered."""

    order: Literal["release"] = "release"


class Clear(Order[replies.Done]):
    """Look at the controller behind a fault; where all is well, motions are possible again."""

    order: Literal["clear"] = "clear"


class Look(Order[replies.Looked]):
    """Look at everything on the controller that must be so before a motion; nothing moves."""

    order: Literal["look"] = "look"


class AskPlace(Order[replies.Place]):
    """Where is the robot commanded to stand, and where is a frame in another then?"""

    order: Literal["where"] = "where"
    base: Name = "{B}"
    moving: Name = "{TCP}"


class Read(Order[replies.Value]):
    """What is the value of an input or output that the session declares?"""

    order: Literal["read"] = "read"
    name: Name


class SetOutput(Order[replies.Value]):
    """Give an output that the session declares a value, at once."""

    order: Literal["set"] = "set"
    name: Name
    value: Annotated[Number | Literal["ON", "OFF"], Field(description='a number, "ON" or "OFF"')]


class AskDeclarations(Order[replies.Declarations]):
    """What does the session declare?"""

    order: Literal["declarations"] = "declarations"


class Adopt(Order[replies.Adopted]):
    """Let these declarations hold, in the place of all that were accepted before."""

    order: Literal["adopt"] = "adopt"
    declarations: Annotated[tuple[str, ...], Field(description="a list of texts")]


class Offer(Order[replies.Offered]):
    """Plan and prove a line, a block or several lines from where the robot stands. Nothing moves."""

    order: Literal["offer"] = "offer"
    text: Line


class OfferBack(Order[replies.Offered]):
    """Plan and prove the last motion backwards, along the same path. Nothing moves."""

    order: Literal["offer-back"] = "offer-back"


class Go(Order[replies.Ended]):
    """Carry an offer out; answered when it has ended."""

    order: Literal["go"] = "go"
    offer: Annotated[int, Field(description="the number of an offer")]


class Load(Order[replies.Loaded]):
    """Compile and prove a program, or judge a compiled one, to be run. Nothing moves."""

    order: Literal["load"] = "load"
    file: Annotated[str, Field(description="the path of a file")]
    """Its path; its name, where `text` is given."""
    text: Annotated[str | None, Field(description="a text, or null")] = None
    """Of the program, in the place of the file's."""
    first: Annotated[str | None, Field(description="the index of a command, or null")] = None
    """The command to begin with."""
    by_steps: Annotated[bool, Field(description="true or false")] = False
    here: Annotated[bool, Field(description="true or false")] = False
    """Whether a program that doesn't say START begins where the robot stands."""
    start: Annotated[tuple[Number, ...] | None, Field(description="a list of numbers, or null")] = None
    """Where the program starts [deg or mm]."""
    tolerance: Annotated[
        tuple[Number, ...] | None, Field(max_length=2, description="one or two numbers, or null")
    ] = None
    """Of the path [mm], and of the tool's orientation [deg]."""
    tm: Annotated[Number | None, Field(description="a number, or null")] = None
    """The longest segment time [ms]."""
    cell: Annotated[str | None, Field(description="the path of a file, or null")] = None
    """Of a compiled program: the description of the surroundings, in the place of its program's."""
    source: Annotated[str | None, Field(description="the path of a file, or null")] = None
    """Of a compiled program: the program that it is judged against, in the place of the one beside it."""
    approach: Annotated[bool, Field(description="true or false")] = False
    """Whether the way to the program's start is wanted as well."""


class AskWay(Order[replies.Way]):
    """What lies between the robot and the start of a program that was loaded?"""

    order: Literal["way"] = "way"
    program: Annotated[int, Field(description="the number of a program")]


class Run(Order[replies.Ended]):
    """Carry a program out that was loaded; answered when it has ended."""

    order: Literal["run"] = "run"
    program: Annotated[int, Field(description="the number of a program")]
    approach: Annotated[bool, Field(description="true or false")] = False
    """Whether to move slowly to its start first, if the robot isn't there."""
    times: Annotated[int | None, Field(ge=1, description="a whole number from 1, or null")] = 1
    """How often; null: until somebody stops it."""


class Save(Order[replies.Saved]):
    """Give the session as a program that does the same, as it would stand in a folder."""

    order: Literal["save"] = "save"
    folder: Annotated[str | None, Field(description="the path of a folder, or null")] = None
    """Names of files are written as they are seen from there."""


class Steer(Order[replies.Done]):
    """Say how live motions are made from now on, before the first of them is wanted."""

    order: Literal["steer"] = "steer"
    moving: Name = "{TCP}"
    """The frame that twists move, whose poses are meant, and whose speed is limited."""
    speed: Annotated[float | None, Field(gt=0.0, le=1e9, description="a positive number, or null")] = None
    """The largest of that frame [mm/s]; null: the robot's jog speed."""
    again: Annotated[bool, Field(description="true or false")] = True
    """Whether another motion begins where something is wanted behind the end of one; else each is to be announced by this order."""
    title: Name = "master"
    """What the motion is called."""


class Leave(Order[replies.Done]):
    """Bring the live motion to rest at once that this client steers, if there is one: nobody is there any more who wants it."""

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
    AskPlace,
    Read,
    SetOutput,
    AskDeclarations,
    Adopt,
    Offer,
    OfferBack,
    Go,
    Load,
    AskWay,
    Run,
    Save,
    Steer,
    Leave,
)
"""All orders, in the order of the documentation."""
