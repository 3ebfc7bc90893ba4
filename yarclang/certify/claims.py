"""Values that the planner claims about a controller text, to help the judge's proofs.

Each claim is checked: a wrong claim can make a proof fail, but it can't make a wrong text pass. There are
three exceptions. `any_jerk`: the certificate reports that the jerk of these motions wasn't judged. `overlaps`
and `postures`: the judge takes them as they are, to refuse texts whose map states longer blends, or that end
in another posture.
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
        witnesses: chosen joint positions [rad or m]. The judge checks them against the waypoints by forward
            kinematics. A SplineMove has one row for each of its k waypoints (k, n). An AvoidMove has one row
            for each waypoint that was found, with the goal in the last row (k, n). Some motions that flow
            into the next one have one row, the joint positions at their end (1, n): JointMoves to a pose, and
            Cartesian motions before a motion in joint space.
        laws: for SplineMoves and PoseSplineMoves, the fraction of the path that is covered over time, as
            control values (segments + 3,) of a cubic B-spline. The judge compares the executed motion with
            the path at this fraction. In a chain, the B-spline also covers half of the blend before and half
            of the blend after the motion's own segments.
        kept: ratio of the reached speed to the programmed one, if less than 1. The judge checks the text
            against this ratio and reports it (Y0610).
        least: in a chain, the lowest ratio of the speed to the programmed speed, after the programmed speed
            has first been reached. The judge checks that the speed stays between this ratio and 1, and
            reports the ratio as well.
        overlaps: duration of the blend at the end of each motion that flows into the next one [s]. At a
            corner without a ball, the blend in the text's map may not take longer; without a claim, such a
            corner may have no blend. This claim only restricts texts: a wrong one can't make the judge accept
            what it would refuse if blends had any length.
        postures: joint positions (n,) at which each joint motion to a pose comes to rest [rad or m]. A pose
            can be reached in several postures; the text must end in this one. This claim only restricts
            texts, too.
        any_jerk: steps whose motion profile has no jerk limit. The judge checks that the text's map lifts the
            jerk limit of no other motion. The certificate lists the jerk of these motions as not judged.
    """

    witnesses: Mapping[int, Array] = field(default_factory=dict)
    laws: Mapping[int, Array] = field(default_factory=dict)
    kept: Mapping[int, float] = field(default_factory=dict)
    least: Mapping[int, float] = field(default_factory=dict)
    overlaps: Mapping[int, float] = field(default_factory=dict)
    postures: Mapping[int, Array] = field(default_factory=dict)
    any_jerk: frozenset[int] = frozenset()
