"""Findings of family 11, first part: what the controller's segments can do."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1101",
        "segment-time-rounded",
        "error",
        "the controller would round this segment time",
        "TM is kept in steps of 1/4096 ms. A segment time between two steps would make the whole motion "
        "run faster or slower than asked.",
        "yarcc --tm 5.0001",
        "yarcc --tm 5",
    ),
    Finding(
        "Y1102",
        "segment-time-too-long",
        "error",
        "the segment time is longer than the robot or the controller takes",
        "The controller clips TM at 4096 ms, and robot.toml says the longest for this robot "
        "(controller.largest_tm): the path error grows with the fourth power of the segment time.",
        "yarcc --tm 80",
        "yarcc --tm 50",
    ),
    Finding(
        "Y1103",
        "segment-time-too-short",
        "error",
        "the controller can't calculate segments this short in time",
        "A segment has to last longer than three real-time interrupts, which come every I8 + 1 servo "
        "cycles. Otherwise the next move isn't ready and the program ends with a run-time error.",
        "yarcc --tm 1",
        "yarcc --tm 5",
    ),
    Finding(
        "Y1104",
        "not-for-this-controller",
        "error",
        "the robot's controller can't do this",
        "Controllers differ in their targets, and in their actions between motions. yarcc writes only "
        "texts that the robot's own controller can execute.",
        "yarcc --target tape",
        "yarcc --target prog",
    ),
    Finding(
        "Y1105",
        "output-not-in-motion",
        "error",
        "the controller can't set this variable while motions flow",
        "Between two motions that flow into each other the robot doesn't rest, so that an output there is "
        "set in step with the motion. A Turbo PMAC does that with M-variables; a P- or Q-variable would "
        "change earlier, when the line is computed.",
        "OUTPUT GLUE P100 OFF\n"
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) BLEND 2\n"
        "P0020 SET GLUE ON\n"
        "P0030 MOVEJ 10 0 0 0 30 0 [5] (deg,s)",
        "OUTPUT GLUE M1 OFF\n"
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) BLEND 2\n"
        "P0020 SET GLUE ON\n"
        "P0030 MOVEJ 10 0 0 0 30 0 [5] (deg,s)",
    ),
    Finding(
        "Y1106",
        "needs-streaming",
        "error",
        "a program buffer can't decide this",
        "Registers, conditions with AND, OR, NOT and comparisons, and the ways of a CASE are decided by "
        "the runtime, which sends leg after leg. A text for a program buffer runs without it.",
    ),
)
