"""Findings of family 16: runs on a controller."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1601",
        "run-ended",
        "error",
        "the run can't go on",
        "Something that the run needs has failed: the log, the disk, or a time limit of the controller. "
        "The robot was brought to rest; the message gives the reason, and the lines after it the place of "
        "the robot.",
    ),
    Finding(
        "Y1602",
        "motor-fault",
        "error",
        "a motor can't move",
        "The controller has stopped a motor: its following error is beyond Ixx11, a limit switch or a "
        "software limit is reached, its amplifier reports a fault, its loop is open, or the controller was "
        "reset. The message names the command that was being executed.",
    ),
    Finding(
        "Y1603",
        "line-refused",
        "error",
        "the controller refuses a line",
        "The controller answers a line with ERRnnn. The message names the command of the refused line, "
        "which may be some lines ahead of the robot.",
    ),
    Finding(
        "Y1604",
        "waited-too-long",
        "error",
        "an input didn't come in time",
        "A WAIT has a time limit, and its condition didn't hold within it. The robot stands where the WAIT "
        "began.",
    ),
    Finding(
        "Y1605",
        "program-not-executed",
        "error",
        "the controller doesn't execute the program",
        "There are four causes: the controller couldn't calculate a move in time; another client has "
        "stopped the program or changed a proved setting; the controller commands the motors off the "
        "path; or the program has ended at a wrong place.",
    ),
    Finding(
        "Y1606",
        "connection-lost",
        "error",
        "the connection was lost while the robot moved",
        "The link was closed, a reply came too late, or the received bytes can't be a reply. The guard PLC "
        "holds the motion on its path when the buffer runs low.",
    ),
    Finding(
        "Y1607",
        "ran-dry",
        "error",
        "the controller's buffer ran dry",
        "The robot used the lines faster than they came, and no guard held the motion in time: the robot "
        "rests at the last calculated point, off its path.",
    ),
    Finding(
        "Y1608",
        "begun-in-a-corner",
        "error",
        "a run can't begin between motions that flow into each other",
        "If a motion flows into the next one (BLEND), the robot doesn't stop at the corner. The second "
        "motion was planned and proved from the corner in motion, so it can't be executed alone. A run "
        "begins, and --step pauses, at a motion that begins at rest; the message names the first motion "
        "of the chain.",
    ),
    Finding(
        "Y1611",
        "not-the-owner",
        "error",
        "somebody else owns the robot",
        "One client of a coordinator may move the robot, all others watch: two persons moving one robot "
        "wouldn't know of each other. The owner releases it or hands it over. Stop, hold and abort are for "
        "everybody.",
    ),
    Finding(
        "Y1612",
        "robot-busy",
        "error",
        "the robot is under way",
        "A motion is planned from the place at which the robot stands, and executed alone: wait until the "
        "current motion has ended, or stop it.",
    ),
    Finding(
        "Y1613",
        "stale-offer",
        "error",
        "an offer is out of date",
        "A motion was planned from the place and the declarations at that time. Since then the robot was "
        "moved, or a declaration was added: the motion would not be the one that was shown.",
    ),
    Finding(
        "Y1614",
        "no-way-back",
        "error",
        "there is no motion to reverse",
        "The last motion is reversed along its own path. This isn't possible if nothing has moved yet, if "
        "the robot was moved by something else since (a jog, another program), or if it was stopped within "
        "a spline, whose remaining part isn't the same curve.",
    ),
    Finding(
        "Y1615",
        "start-in-a-session",
        "error",
        "a session has no START",
        "START gives the robot's position before a program. In a session each command is planned from the "
        "robot's actual position.",
        "START HOME",
        "P0010 MOVEJ HOME [50%] (deg,s)",
    ),
    Finding(
        "Y1616",
        "no-live-motion",
        "error",
        "a jog can't begin here",
        "Each increment of a jog, of a velocity and of a master that is followed is proved before it is "
        "streamed: limits, distances of bodies, zones. If the robot's present position already breaks one "
        "of them, or a frame isn't one of the robot's, nothing can be proved.",
    ),
    Finding(
        "Y1617",
        "no-such-signal",
        "error",
        "a script names an unknown input, output or command",
        "A script of inputs (`yarc run --inputs`) changes the inputs of the program and its cell, by their "
        "names or as variables such as M11, and may wait for an output or a command of the program. With "
        "another name it would wait for ever.",
    ),
    Finding(
        "Y1618",
        "contradictory-input",
        "error",
        "an entry of a script can't be carried out",
        "Each entry of a script of inputs has an input, its value, and exactly one moment: a time, a "
        "place in the program, or an output that changes to a value. An output is set by the program, so "
        "a script can't set it. An input that is stuck doesn't change any more.",
    ),
    Finding(
        "Y1619",
        "input-of-a-real-controller",
        "error",
        "an input of a real controller can't be set",
        "The inputs of a real controller are set by the connected machines. A person can set them only for "
        "a robot that is simulated in the coordinator's own process (`yarc run`, `serve` and `repl`).",
    ),
    Finding(
        "Y1620",
        "parts-elsewhere",
        "error",
        "parts of the cell were moved after the proof",
        "A program, a line or a jog is proved with the parts of the cell in their present places. Since "
        "then a gripper has moved a part, or somebody has entered another place; or the places are unknown "
        "after a run without a known end. Load the program again, or enter the places: `.parts` at the "
        "prompt.",
    ),
    Finding(
        "Y1621",
        "not-simple-message",
        "error",
        "a client of the ROS server doesn't send simple_message",
        "Frames of simple_message have a length from 12 to 1020 bytes, a purpose, and a body of a known "
        "size. After other bytes the begin of the next frame isn't known, so the connection is closed. "
        "Usually the byte order is wrong: use `yarc ros --swap-bytes`, or leave it out.",
    ),
    Finding(
        "Y1622",
        "ros-point",
        "error",
        "a way-point from ROS can't be used",
        "Each way-point has a number for each joint of robot.toml, in its order, zeros in the other slots, "
        "and a duration above 0. The stock client doesn't show why a goal is refused; the terminal of "
        "`yarc ros` does, and robot_status has this number as its error_code until the next goal.",
    ),
    Finding(
        "Y1623",
        "ros-points-missing",
        "error",
        "a goal from ROS is incomplete",
        "The stock client counts its way-points from 0, sends one each few milliseconds, and doesn't mark "
        "the end. A goal with a gap, one whose client was gone for 10 s within it, a download without an "
        "end, and a point that comes after the goal has started aren't executed: a part of a trajectory "
        "isn't the planned motion.",
    ),
    Finding(
        "Y1624",
        "ros-goal-ended",
        "error",
        "a goal from ROS was ended before its last point",
        "Somebody else has stopped the robot, or the run has failed. The stock client has no message for "
        "this: its goal stays active until it is cancelled.",
    ),
    Finding(
        "Y1625",
        "ros-second-client",
        "error",
        "one client at a time moves the robot on the motion link",
        "Way-points of two clients would mix in one path. A second client waits until the first has "
        "disconnected; its way-points are answered with FAILURE, but its stop is executed. The state link "
        "serves many clients.",
    ),
    Finding(
        "Y1630",
        "register-out-of-range",
        "error",
        "a register would leave its range",
        "The program declares the range of a register. A value outside of it, one that isn't an integer, "
        "or a division by zero ends the run at rest, before the value is used.",
    ),
    Finding(
        "Y1635",
        "program-aborted",
        "error",
        "the program has ended the run with ABORT",
        "The program reached an ABORT, whose text gives the reason. The robot stands, outputs have their "
        "safe values, and the run can't be resumed.",
    ),
    Finding(
        "Y1636",
        "register-not-kept",
        "error",
        "the value of a KEPT register can't be read or written",
        "A KEPT register begins the next run with its last value. Each value is on the disk before the "
        "robot goes on; if it can't be written, the run ends at rest, since a count that is lost in a "
        "power cut is worse than a robot that stands.",
    ),
    Finding(
        "Y1637",
        "watched-input",
        "error",
        "a watched input has held the motion of an unattended run",
        "ON CURTAIN OFF HOLD holds the motion on its path, with outputs safe, until a person resumes it. "
        "An unattended run ends there.",
    ),
    Finding(
        "Y1638",
        "not-from-here",
        "error",
        "the next motion isn't possible from the place at which an input has ended a motion",
        "A motion with UNTIL ends where its input is found. The next motion is planned and proved from "
        "there before it begins; if this fails, the robot stays at that place, and the run ends. The same "
        "holds for the way back and the way out of ON ... CALL.",
    ),
    Finding(
        "Y1650",
        "bit-reads-a-number",
        "error",
        "a bit of a group has a value other than 0 or 1",
        "An M-variable may point to one bit of the controller's memory or to a word. A word in the place "
        "of a bit would give the group a wrong number, so the value isn't used.",
    ),
    Finding(
        "Y1651",
        "unsteady-group",
        "error",
        "a group of inputs didn't hold still for a second",
        "Bits of a group are read one after the other, so a number counts only if two readings, 20 ms "
        "apart, agree. If no two readings within a second agree, the inputs change too quickly to be used.",
    ),
    Finding(
        "Y1660",
        "not-recovered",
        "error",
        "no proved motion leads to the program",
        "No motion from the robot's position to the program's start, or to one of the nearest places at "
        "which the program may begin, could be proved to stay within the limits, clear of all bodies and "
        "in accordance with the zones. If the robot touches a body, or a part isn't at its place in the "
        "program, a person who sees the robot has to move it into the open.",
    ),
    Finding(
        "Y1661",
        "values-not-wanted",
        "error",
        "values from outside come when no WAIT or HOLD takes them",
        "A program accepts values only while it stands at a WAIT whose condition has registers that are "
        "filled from OUTSIDE, or at a HOLD, and one message for each question. A message that comes too "
        "early, too late or twice may have been meant for another question.",
    ),
    Finding(
        "Y1662",
        "value-out-of-range",
        "error",
        "a value from outside is beyond its register's range",
        "The program was proved for the range that its REGISTER line names. Nothing of the message is "
        "taken, and the question stays open.",
    ),
    Finding(
        "Y1663",
        "values-not-understood",
        "error",
        "values from outside don't fit the registers",
        "A message names registers that are filled from OUTSIDE, each with an integer, and all that the "
        "condition of the WAIT has. Nothing of the message is taken, and the question stays open.",
    ),
)
