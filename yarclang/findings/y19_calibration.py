"""Findings of family 19: calibration of tools, frames and joints."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1901",
        "too-few-touches",
        "error",
        "there are too few points for a calibration",
        "A tool's tip needs four touches of the same point. A frame needs three points: its origin, a point "
        "on its x axis, and another point of its xy plane. A joint's offset needs a touch of the joint's "
        "mark. Additional touches show how accurate the result is.",
    ),
    Finding(
        "Y1902",
        "touches-too-alike",
        "error",
        "the tool had the same orientation in all touches",
        "The place of the tip is computed from touches with different orientations. If the orientations are "
        "too similar, even a small error of a touch becomes an error of centimetres.",
    ),
    Finding(
        "Y1903",
        "points-too-near",
        "error",
        "points are too near to each other, or on one line",
        "The directions of a frame's axes are computed from its points. If the points are too near to each "
        "other, small errors turn the frame, and all poses in it, by degrees.",
    ),
    Finding(
        "Y1904",
        "touches-contradict",
        "warning",
        "the points contradict each other",
        "The result is a best fit. Its error is about as large as the disagreement of the points. The usual "
        "cause is an inaccurate touch; less often, a joint has a wrong zero.",
    ),
    Finding(
        "Y1905",
        "mark-of-no-joint",
        "error",
        "the robot has no joint of this name",
        "An offset at the wrong joint would shift all taught positions, so the joint's name must be one of "
        "the robot.",
    ),
)
