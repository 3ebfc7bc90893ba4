"""Family 19: calibration of tools, frames and joints."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1901",
        "too-few-touches",
        "error",
        "there aren't enough points to calibrate with",
        "A tool's tip needs four touches of one point, a frame its origin, a point on x and one of the plane, a joint's offset its mark. Touches beyond these show how "
        "exact the result is.",
    ),
    Finding(
        "Y1902",
        "touches-too-alike",
        "error",
        "the tool pointed the same way in all touches",
        "Where the tip is follows from how it moves when the tool turns. Along a direction that didn't turn nothing is known, and the smallest error of a touch "
        "becomes an error of centimetres.",
    ),
    Finding(
        "Y1903",
        "points-too-near",
        "error",
        "points are too near to each other, or in a line",
        "A frame's directions come from the distances between its points. Near each other they turn the frame, and all poses in it, by degrees.",
    ),
    Finding(
        "Y1904",
        "touches-contradict",
        "warning",
        "the points contradict each other",
        "What is calculated from them is a mean, and wrong by about what they miss each other. A point that was touched badly is the usual reason, a wrong zero of a joint the next.",
    ),
    Finding(
        "Y1905",
        "mark-of-no-joint",
        "error",
        "the robot has no joint of this name",
        "An offset that is written to the wrong joint moves the arm beside everything that was taught.",
    ),
)
