"""Findings of family 19: calibration of tools, frames and joints."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1901",
        "too-few-touches",
        "error",
        "there are too few points for a calibration",
        "A tool's tip needs four touches of one point, a frame its origin, a point on x and one of the "
        "plane, a joint's offset its mark. Touches beyond these show how exact the result is.",
    ),
    Finding(
        "Y1902",
        "touches-too-alike",
        "error",
        "the tool pointed the same way in all touches",
        "The place of the tip is computed from touches with different orientations. Without enough "
        "rotation, the smallest error of a touch becomes an error of centimetres.",
    ),
    Finding(
        "Y1903",
        "points-too-near",
        "error",
        "points are too near to each other, or in a line",
        "A frame's directions come from the distances between its points. If they are too near to each "
        "other, small errors turn the frame, and all poses in it, by degrees.",
    ),
    Finding(
        "Y1904",
        "touches-contradict",
        "warning",
        "the points contradict each other",
        "The result is a mean, with an error of about their disagreement. The usual reason is a badly "
        "touched point, the next a wrong zero of a joint.",
    ),
    Finding(
        "Y1905",
        "mark-of-no-joint",
        "error",
        "the robot has no joint of this name",
        "An offset at the wrong joint would shift all taught positions.",
    ),
)
