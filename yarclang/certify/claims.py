"""What the planner claims about a controller text, to help the judge's proofs.

Each claim is checked: a wrong claim can make a proof fail, but it can't make a wrong text pass. The exception
is `any_jerk`: the certificate reports that the jerk of these motions wasn't judged.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

from yarclang.frozen import frozen
from yarclang.robot.model import Array


@frozen
class Claims:
    """All values that the planner passes to the judge, by the index of a motion in the program's steps.

    Attributes:
        witnesses: chosen joint positions [rad or m], checked against the way-points by forward kinematics.
            For a SplineMove (k, n), one row for each of its k way-points. For an AvoidMove (k, n), the
            way-points found, with the goal in the last row. For some motions that flow into the next one
            (1, n), the joint positions at their end: a JointMove to a pose, and a Cartesian motion before a
            motion in joint space.
        laws: for SplineMoves and PoseSplineMoves, the path parameter over time, from which the deviation is
            measured: (segments + 3,) control values of the share of the path. In a chain, the segments reach
            half a blend beyond the motion's own segments on either side.
        kept: ratio of the reached speed to the programmed one, if less than 1. The judge checks the text
            against this ratio and reports it (Y0610).
        least: in a chain, the lowest ratio of the speed to the programmed one, once that has been reached.
            The judge checks that the speed stays between this ratio and 1, and reports the ratio as well.
        any_jerk: steps whose motion profile has no jerk limit. The judge checks that the text's map lifts the
            jerk limit of no other motion; the certificate lists the jerk of these motions as not judged.
    """

    witnesses: Mapping[int, Array] = field(default_factory=dict)
    laws: Mapping[int, Array] = field(default_factory=dict)
    kept: Mapping[int, float] = field(default_factory=dict)
    least: Mapping[int, float] = field(default_factory=dict)
    any_jerk: frozenset[int] = frozenset()
