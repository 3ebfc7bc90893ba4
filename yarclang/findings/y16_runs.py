"""Findings of family 16: runs on a controller."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1601",
        "run-ended",
        "error",
        "the run can't go on",
        "Something that the run needs has failed: the log, the disk, or a reply of the controller within "
        "its time limit. The robot was brought to rest. The message gives the reason, and the lines after "
        "it give the position of the robot.",
    ),
    Finding(
        "Y1602",
        "motor-fault",
        "error",
        "a motor can't move",
        "The controller has stopped a motor. Either its following error is beyond Ixx11, it has reached a "
        "limit switch or a software limit, its amplifier reports a fault, its loop is open, or the "
        "controller was reset. The message names the command that was being executed.",
    ),
    Finding(
        "Y1603",
        "line-refused",
        "error",
        "the controller refuses a line",
        "The controller answers a line with ERRnnn. The message names the command that the line belongs to. "
        "The robot may not have reached this command yet, because lines are sent ahead.",
    ),
    Finding(
        "Y1604",
        "waited-too-long",
        "error",
        "an input didn't come in time",
        "The condition of a WAIT didn't become true within its time limit. The robot is at rest at the "
        "place of the WAIT.",
    ),
    Finding(
        "Y1605",
        "program-not-executed",
        "error",
        "the controller doesn't execute the program",
        "There are four possible causes. The controller couldn't calculate a move in time. Another client "
        "has stopped the program or changed a proved setting. The controller commands the motors off the "
        "path. The program has ended at a wrong place.",
    ),
    Finding(
        "Y1606",
        "connection-lost",
        "error",
        "the connection was lost while the robot moved",
        "The connection was closed, a reply came too late, or the received bytes can't be a reply. When the "
        "buffer runs low, the guard PLC holds the motion on its path.",
    ),
    Finding(
        "Y1607",
        "ran-dry",
        "error",
        "the controller's buffer ran dry",
        "The robot used the lines faster than they were sent, and no guard held the motion in time. The "
        "robot is at rest at the last calculated point, off its path.",
    ),
    Finding(
        "Y1608",
        "begun-in-a-corner",
        "error",
        "a run can't begin between motions that flow into each other",
        "If a motion flows into the next one (BLEND), the robot doesn't stop at the corner. The second "
        "motion was planned and proved with the velocity that the robot has there, so it can't be executed "
        "alone. A run can begin, and --step can pause, only at a motion that begins at rest. The message "
        "names the first motion of the chain.",
    ),
    Finding(
        "Y1611",
        "not-the-owner",
        "error",
        "somebody else owns the robot",
        "Only one client of a coordinator, its owner, may move the robot; all others watch. Two persons who "
        "move one robot wouldn't know of each other. The owner can release the robot or hand it over. Stop, "
        "hold and abort are allowed for everybody.",
    ),
    Finding(
        "Y1612",
        "robot-busy",
        "error",
        "the robot is under way",
        "A new motion is planned from the position of a robot at rest, and nothing else may move the robot "
        "at the same time. Wait until the current motion has ended, or stop it. Work on the controller, "
        "such as homing, also needs a robot at rest.",
    ),
    Finding(
        "Y1613",
        "stale-offer",
        "error",
        "an offer is out of date",
        "An offer is planned from the robot's position and the declarations at that time. Since then, the "
        "robot was moved or a declaration was added, so the motion would not be the one that was shown.",
    ),
    Finding(
        "Y1614",
        "no-way-back",
        "error",
        "there is no motion to reverse",
        "The last motion is reversed along its own path. This isn't possible if nothing has moved yet, or "
        "if something else (a jog, another program) has moved the robot since. It isn't possible either if "
        "the robot was stopped within a spline or a timetable: planned from the middle, the rest would be "
        "another curve.",
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
        "a jog or another live motion isn't possible here",
        "Jogs, motions at a velocity and motions that follow a master are proved piece by piece, each piece "
        "before it is streamed: limits, distances of bodies, zones. If the robot's present position already "
        "violates one of them, or if a given frame or joint isn't the robot's, nothing can be proved.",
    ),
    Finding(
        "Y1617",
        "no-such-signal",
        "error",
        "a script names an unknown input, output or command",
        "A script of inputs (`yarc run --inputs`) changes the inputs of the program and its cell. It names "
        "them by their names, or as variables such as M11. It may also wait for an output or a command of "
        "the program. With an unknown name, the script would wait for ever.",
    ),
    Finding(
        "Y1618",
        "contradictory-input",
        "error",
        "an entry of a script can't be carried out",
        "Each entry of a script of inputs needs an input, its value, and exactly one moment: a time, a "
        "place in the program, or an output that changes to a value. A script can't set an output, because "
        "the program sets it. An input that an entry declares as stuck can't change any more.",
    ),
    Finding(
        "Y1619",
        "input-of-a-real-controller",
        "error",
        "an input of a real controller can't be set",
        "The inputs of a real controller are set by the connected machines. A person can set inputs only "
        "for a robot that is simulated in the coordinator's own process (`yarc run`, `serve` and `repl`).",
    ),
    Finding(
        "Y1620",
        "parts-elsewhere",
        "error",
        "parts of the cell were moved after the proof",
        "A program, a line or a jog is proved with the parts of the cell in their present places. Since "
        "then, a gripper has moved a part, or somebody has entered another place. Or the places are "
        "unknown, because it isn't known how an earlier run ended. Load the program again, or enter the "
        "places: `.parts` at the prompt.",
    ),
    Finding(
        "Y1621",
        "not-simple-message",
        "error",
        "a client of the ROS server doesn't send simple_message",
        "Each message of simple_message has a length from 12 to 1020 bytes, a purpose, and a body of a "
        "known size. Once other bytes were received, the beginning of the next message isn't known, so the "
        "connection is closed. Usually the byte order is wrong: add `--swap-bytes` to `yarc ros`, or remove "
        "it.",
    ),
    Finding(
        "Y1622",
        "ros-point",
        "error",
        "a waypoint from ROS can't be used",
        "Each waypoint needs a number for each joint of robot.toml, in the order of robot.toml, zeros in "
        "all other slots, and a duration above 0. The stock client of ROS-Industrial doesn't show why a "
        "goal is refused. The terminal of `yarc ros` shows it, and robot_status has the number 1622 as its "
        "error_code until the next goal.",
    ),
    Finding(
        "Y1623",
        "ros-points-missing",
        "error",
        "a goal from ROS is incomplete",
        "The stock client of ROS-Industrial counts its waypoints from 0, sends one every few milliseconds, "
        "and doesn't mark the end. A goal is not executed if a waypoint is missing, if its client was "
        "disconnected for 10 s before the goal was complete, or if a download has no end. A waypoint that "
        "comes after the goal has started is not executed either. A part of a trajectory isn't the planned "
        "motion.",
    ),
    Finding(
        "Y1624",
        "ros-goal-ended",
        "error",
        "a goal from ROS was ended before its last point",
        "Somebody else has stopped the robot, or the run has failed. The stock client of ROS-Industrial has "
        "no message for this, so its goal stays active until it is cancelled.",
    ),
    Finding(
        "Y1625",
        "ros-second-client",
        "error",
        "only one client at a time can move the robot on the motion link",
        "Waypoints of two clients would be mixed in one path. A second client must wait until the first "
        "one has disconnected. Until then, its waypoints are answered with FAILURE, but its stop is "
        "executed. The state link serves many clients.",
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
        "The program has reached an ABORT, whose text gives the reason. The robot is at rest, outputs have "
        "their safe values, and the run can't be resumed.",
    ),
    Finding(
        "Y1636",
        "register-not-kept",
        "error",
        "the value of a KEPT register can't be read or written",
        "A KEPT register begins the next run with its last value. So each new value is written to the disk "
        "before the robot goes on. If the value can't be written, the run ends at rest: a count that is "
        "lost in a power cut is worse than a robot that stops.",
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
        "A motion with UNTIL ends where its input is found. The next motion is planned and proved from this "
        "place before it begins. Here this failed, so the robot stays at this place, and the run ends. The "
        "finding is also reported after ON ... CALL, if the motion back to the start of the held motion, or "
        "the SUB, can't be planned from the robot's position.",
    ),
    Finding(
        "Y1650",
        "bit-reads-a-number",
        "error",
        "a bit of a group has a value other than 0 or 1",
        "An M-variable may refer to one bit of the controller's memory, or to a word of several bits. If a "
        "word is used in the place of a bit, the group gets a wrong number, so the value isn't used.",
    ),
    Finding(
        "Y1651",
        "unsteady-group",
        "error",
        "the bits of a group kept changing for a second",
        "The bits of a group are read one after the other, so a number counts only if two readings, 20 ms "
        "apart, agree. If no two such readings within a second agree, the inputs change too quickly to be "
        "used.",
    ),
    Finding(
        "Y1660",
        "not-recovered",
        "error",
        "no proved motion leads to the program",
        "The program may begin at its start, or at other places of its path. No motion from the robot's "
        "position to its start, or to one of the nearest other places, could be proved: a motion must stay "
        "within the limits, clear of all bodies and in accordance with the zones. If the robot touches a "
        "body, or a part isn't at its place in the program, a person who sees the robot has to move it into "
        "the open.",
    ),
    Finding(
        "Y1661",
        "values-not-wanted",
        "error",
        "values from outside come when no WAIT or HOLD takes them",
        "A program accepts values from outside only while it is at a WAIT whose condition has registers "
        "that are filled from OUTSIDE, or at a HOLD. Each WAIT or HOLD is a question, which takes one "
        "message as its answer. A message that comes too early, too late or twice may be the answer to "
        "another question.",
    ),
    Finding(
        "Y1662",
        "value-out-of-range",
        "error",
        "a value from outside is beyond its register's range",
        "The program was proved for the range that the register's REGISTER line gives. No value of the "
        "message is used, and the program still waits for an answer.",
    ),
    Finding(
        "Y1663",
        "values-not-understood",
        "error",
        "values from outside don't fit the registers",
        "A message may name only registers that are filled from OUTSIDE, each with an integer. It must name "
        "all of these registers that the condition of the WAIT contains. Here it doesn't, so no value of "
        "the message is used, and the program still waits for an answer.",
    ),
)
