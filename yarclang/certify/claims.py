"""What the planner claims of a text: each claim is checked, and a wrong one proves less, never more."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

from yarclang.frozen import frozen
from yarclang.robot.model import Array


@frozen
class Claims:
    """All values that cross from the planner to the judge, by the number of a motion in the program's steps.

    Attributes:
        witnesses: the joint positions [rad or m] that were chosen: for each SplineMove (k, n) for its k way-points, for each AvoidMove as many as
            were found, the goal last; for a JointMove to a pose that flows into the next motion, and, where that one is in joint space, for a
            Cartesian motion, (1, n) for its end. Checked against the way-points by forward kinematics.
        laws: for SplineMoves and PoseSplineMoves, control values (segments + 3,) of the share of the way over time. The segments of a motion in
            a chain reach half a blend beyond its own on either side. The deviation is measured from the path at these shares.
        kept: the share of its programmed speed that a motion reaches, if not all of it. The text is held to that share, and the judge
            reports it (Y0610).
        least: the share of its programmed speed below which a motion in a chain doesn't fall, once that is reached. The speed has to be between it and
            the whole, not always far above it; the judge reports it as well.
        any_jerk: steps whose law has no limit of the jerk. Each must be one by the profile that the program names; the certificate reports
            their jerk as not judged.
    """

    witnesses: Mapping[int, Array] = field(default_factory=dict)
    laws: Mapping[int, Array] = field(default_factory=dict)
    kept: Mapping[int, float] = field(default_factory=dict)
    least: Mapping[int, float] = field(default_factory=dict)
    any_jerk: frozenset[int] = frozenset()
