"""Family 16: runs on a controller."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1601",
        "run-ended",
        "error",
        "the run can't go on",
        "Something that the run needs has failed: the log, the disk, the controller's patience. The robot was brought to rest; the message "
        "says what is the matter, and the lines behind it where the robot stands.",
    ),
    Finding(
        "Y1602",
        "motor-fault",
        "error",
        "a motor can't move",
        "The controller has stopped a motor: its following error is beyond Ixx11, a limit switch or a software limit is reached, its "
        "amplifier reports a fault, its loop is open, or the controller was reset. The command is the one that was executed then.",
    ),
    Finding(
        "Y1603",
        "line-refused",
        "error",
        "the controller refuses a line",
        "The controller answers a line with ERRnnn. The command is the one that the refused line belongs to, which may be some lines ahead "
        "of the robot.",
    ),
    Finding(
        "Y1604",
        "waited-too-long",
        "error",
        "an input didn't come in time",
        "A WAIT on an input has a longest time, and the input isn't as it should be by then. The robot stands where the WAIT found it.",
    ),
    Finding(
        "Y1605",
        "program-not-executed",
        "error",
        "the controller doesn't execute the program",
        "The controller couldn't calculate a move in time, or somebody else has stopped the program or changed what was proved, or it commands the motors "
        "off the path of its lines, or it has ended at another place than it should.",
    ),
    Finding(
        "Y1606",
        "connection-lost",
        "error",
        "the connection was lost while the robot moved",
        "The link was closed, a reply came too late, or what came can't be a reply. The guard PLC holds the motion on its path when the buffer "
        "runs low.",
    ),
    Finding(
        "Y1607",
        "ran-dry",
        "error",
        "the controller's buffer ran dry",
        "The lines of the motion came later than the robot used them up, and no guard held it before: it rests at the last point that was "
        "calculated, off its path.",
    ),
    Finding(
        "Y1608",
        "begun-in-a-corner",
        "error",
        "a run can't begin between motions that flow into each other",
        "Where a motion flows into the next one (BLEND), the robot doesn't stop, and isn't in the corner itself: the second motion can't be carried out "
        "by itself as it was planned and proved. A run begins, and --step pauses, at a motion in front of which the robot stands; the message names the "
        "one that begins the chain.",
    ),
    Finding(
        "Y1611",
        "not-the-owner",
        "error",
        "somebody else owns the robot",
        "One client of a coordinator may move the robot, all others watch: two hands on one robot can't know of each other. The owner releases it or gives it "
        "over. Stop, hold and abort are for everybody.",
    ),
    Finding(
        "Y1612",
        "robot-busy",
        "error",
        "the robot is under way",
        "A motion is planned from where the robot stands, and carried out when nothing else is: what is under way comes to its end first, or is stopped.",
    ),
    Finding(
        "Y1613",
        "stale-offer",
        "error",
        "what was offered doesn't hold any more",
        "A motion was planned from where the robot stood then, behind the lines that were there then. The robot was moved since, or a declaration has come: what would "
        "be done isn't what was shown.",
    ),
    Finding(
        "Y1614",
        "no-way-back",
        "error",
        "there is no motion to take back",
        "The last motion is taken back along its own path. There is none where nothing has moved yet, where the robot was moved by something else since (a jog, another program), "
        "or where it was stopped within a spline, whose rest isn't the same curve.",
    ),
    Finding(
        "Y1615",
        "start-in-a-session",
        "error",
        "a session has no START",
        "START says where the robot stands before a program. In a session each command is planned from where the robot really stands.",
        "START HOME",
        "P0010 MOVEJ HOME [50%] (deg,s)",
    ),
    Finding(
        "Y1616",
        "no-live-motion",
        "error",
        "a jog can't begin here",
        "Each increment of a jog, of a velocity and of a master that is followed is proved before it is streamed: limits, distances of bodies, zones. Where the robot stands already "
        "breaks one of them, or a frame isn't one of the robot's, nothing of it can be proved.",
    ),
    Finding(
        "Y1617",
        "no-such-signal",
        "error",
        "a script names an input, an output or a command that isn't there",
        "A script of inputs (`yarc run --inputs`) changes the inputs of the program and its cell, by their names or as variables such as M11, and may wait for an output or "
        "a command of the program. With another name it would wait for ever.",
    ),
    Finding(
        "Y1618",
        "contradictory-input",
        "error",
        "an entry of a script can't be carried out",
        "Each entry of a script of inputs says what an input becomes, and when: at a time, at a place of the program, or when an output takes a value. It says one of them. An output is set by "
        "the program, not by the machines around the robot; and an input that is stuck isn't changed any more.",
    ),
    Finding(
        "Y1619",
        "input-of-a-real-controller",
        "error",
        "an input of a real controller can't be set",
        "What is connected to a controller sets its inputs. Only a robot that is simulated in the coordinator's own process, as `yarc run`, `serve` and `repl` do it, lets a person "
        "take the part of the machines around it.",
    ),
    Finding(
        "Y1620",
        "parts-elsewhere",
        "error",
        "the parts aren't where they were when this was proved",
        "A program, a line or a jog is proved with the parts of the cell where they are then. Since then a gripper has taken or put one, or somebody has said that it is elsewhere: what was "
        "proved is about other places. Or nobody knows where the parts are, since what has moved them isn't known to its end. Load it again, or say where the parts are: `.parts` at the prompt.",
    ),
    Finding(
        "Y1621",
        "not-simple-message",
        "error",
        "a client of the ROS door sends what isn't simple_message",
        "Frames of simple_message have a length from 12 to 1020 bytes, a purpose, and a body of a known size. After bytes that are nothing of the kind nobody knows where the next frame "
        "begins, so the connection is ended. Most often the words have their bytes in the other order: `yarc ros --swap-bytes`, or without it.",
    ),
    Finding(
        "Y1622",
        "ros-point",
        "error",
        "a way-point from ROS can't be used",
        "Each way-point has a number for each joint of robot.toml, in its order, zeros in the slots beyond, and takes some time. The stock client doesn't tell why a goal is refused; the "
        "terminal of `yarc ros` does, and robot_status has this number as its error_code until the next goal.",
    ),
    Finding(
        "Y1623",
        "ros-points-missing",
        "error",
        "a goal from ROS isn't whole",
        "The stock client counts its way-points from 0, sends one each few milliseconds, and doesn't mark the end. A goal with a gap, one whose client was gone for 10 s within it, a download "
        "without its end, and a point that comes when the goal is in motion already aren't carried out: part of a trajectory isn't what was planned.",
    ),
    Finding(
        "Y1624",
        "ros-goal-ended",
        "error",
        "a goal from ROS was ended before its last point",
        "Somebody else has stopped the robot, or something went wrong on the way. The stock client isn't told more than that: its goal stays active until it is cancelled.",
    ),
    Finding(
        "Y1625",
        "ros-second-client",
        "error",
        "one client at a time moves the robot on the motion link",
        "Way-points of two clients would be one path. A second one waits until the first has gone; its way-points are answered with FAILURE, but a stop of it is carried out. "
        "The state link is for many.",
    ),
    Finding(
        "Y1630",
        "register-out-of-range",
        "error",
        "a register would leave its range",
        "The program says in which range a register stays. A value outside of it, one that is no integer, or a division by zero ends the run where the robot stands, before anything is decided by it.",
    ),
    Finding(
        "Y1635",
        "program-aborted",
        "error",
        "the program has ended the run with ABORT",
        "The program has found something that it was written not to go on with, and says what. The robot stands, outputs are safe, and the run can't be resumed: the way goes on from nowhere.",
    ),
    Finding(
        "Y1636",
        "register-not-kept",
        "error",
        "what a KEPT register holds can't be read or written",
        "A KEPT register goes on in the next run with what it held last. Each of its values is on the disk before the robot goes on; where that can't be done the run ends at rest, since a count that is lost after a power cut is worse "
        "than a robot that stands.",
    ),
    Finding(
        "Y1637",
        "watched-input",
        "error",
        "an input that the program watches has held the motion, and nobody is there",
        "ON CURTAIN OFF HOLD holds the motion on its path, with outputs safe, and only a person says that it goes on. A run that nobody attends ends there.",
    ),
    Finding(
        "Y1638",
        "not-from-here",
        "error",
        "what follows can't be done from where an input has ended a motion",
        "A motion with UNTIL ends where its input is found. What follows is planned and proved from there before it moves; where that can't be done the robot stands on its line, and the run ends. So it is with the way back and the way out of ON ... CALL.",
    ),
    Finding(
        "Y1650",
        "bit-reads-a-number",
        "error",
        "a bit of a group reads something else than 0 or 1",
        "An M-variable may point to one bit of the controller's memory or to a word. A word in the place of a bit would make another number of the group, so nothing is decided by it.",
    ),
    Finding(
        "Y1651",
        "unsteady-group",
        "error",
        "a group of inputs never held still",
        "Bits of a group are read one after the other, so a number counts when two looks, 20 ms apart, find the same. Where no two looks in a second do, somebody else counts on these inputs, and no number of theirs is one to decide by.",
    ),
    Finding(
        "Y1660",
        "not-recovered",
        "error",
        "no proved motion leads to the program",
        "From where the robot stands no motion to the program's start, or to one of the nearest places at which the program may begin, could be proved to stay within the limits, clear of all bodies and in accordance with the zones. "
        "A robot that stands in something, or beside a part that isn't where the program has it, is moved into the open by a person who sees it.",
    ),
    Finding(
        "Y1661",
        "values-not-wanted",
        "error",
        "values from outside that no WAIT or HOLD takes",
        "A program takes values only while it stands at a WAIT whose condition has registers that are filled from OUTSIDE, or at a HOLD, and one message for each question. What comes before, after its time is over, or a second time would be meant for something else.",
    ),
    Finding(
        "Y1662",
        "value-out-of-range",
        "error",
        "a value from outside is beyond its register's range",
        "The program was proved for the range that its REGISTER line names. Nothing of the message is taken, and the question stays open.",
    ),
    Finding(
        "Y1663",
        "values-not-understood",
        "error",
        "values from outside that aren't those of the registers",
        "A message names registers that are filled from OUTSIDE, each with an integer, and all that the condition of the WAIT has. Nothing of the message is taken, and the question stays open.",
    ),
)
