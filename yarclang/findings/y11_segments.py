"""Findings of family 11, first part: what the controller's segments can do."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1101",
        "segment-time-rounded",
        "error",
        "the controller would round this segment time",
        "The controller stores TM in steps of 1/4096 ms. A segment time between two steps would make the "
        "whole motion run faster or slower than programmed.",
        "yarcc --tm 5.0001",
        "yarcc --tm 5",
    ),
    Finding(
        "Y1102",
        "segment-time-too-long",
        "error",
        "the segment time is longer than the robot or the controller allows",
        "The controller clips TM at 4096 ms. In addition, robot.toml sets the longest segment time of this "
        "robot (controller.largest_tm), because the path error grows with the fourth power of the segment "
        "time.",
        "yarcc --tm 80",
        "yarcc --tm 50",
    ),
    Finding(
        "Y1103",
        "segment-time-too-short",
        "error",
        "the controller can't calculate segments this short in time",
        "A segment must last longer than three real-time interrupts of the controller, each of which takes "
        "I8 + 1 servo cycles. Otherwise the next move isn't calculated in time, and the program ends with a "
        "run-time error.",
        "yarcc --tm 1",
        "yarcc --tm 5",
    ),
    Finding(
        "Y1104",
        "not-for-this-controller",
        "error",
        "the robot's controller can't do this",
        "Kinds of controllers differ in the targets (rotary buffer or program buffer) that they offer, and "
        "in the actions that they can carry out between motions. yarcc writes only texts that the robot's "
        "own controller can execute.",
        "yarcc --target tape",
        "yarcc --target prog",
    ),
    Finding(
        "Y1105",
        "output-not-in-motion",
        "error",
        "the controller can't set this variable while motions flow",
        "If two motions flow into each other, the robot doesn't rest between them, so an output there must "
        "be set in step with the motion. A Turbo PMAC can do this with M-variables. A P- or Q-variable "
        "would change too early, when the controller computes the line.",
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
        "Y1107",
        "many-outputs-in-motion",
        "error",
        "too many outputs are set in one blend",
        "If two motions flow into each other, the controller stores the outputs between them until the robot "
        "passes the middle of the blend. Its manuals don't state for how many it has room. yarclang sets at "
        "most 64 bits there, each bit of a group of outputs counted.",
    ),
    Finding(
        "Y1106",
        "needs-streaming",
        "error",
        "a program buffer can't decide this",
        "The runtime decides conditions with registers, AND, OR, NOT and comparisons, and the branches of a "
        "CASE; therefore it sends the text piece by piece. A text for a program buffer is executed without "
        "the runtime.",
    ),
)
