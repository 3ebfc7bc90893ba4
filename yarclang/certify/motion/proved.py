"""Data that the proofs of a controller text's motions share."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from yarclang.certify.blends.flows import Flows
from yarclang.certify.blends.starts import Starts
from yarclang.certify.certificate import Deviation, ToolSpeed
from yarclang.certify.judged import Judged
from yarclang.certify.motion.programmed import FramePaths
from yarclang.certify.motion.spline import NaturalSpline
from yarclang.certify.read.layout import Place
from yarclang.robot.model import Array


@dataclass(slots=True, eq=False)
class Proofs:
    """Proved deviations and speeds of all motions, with the paths that the proofs are about.

    Attributes:
        starts: the start point of each motion's programmed path.
        flows: the blends between motions, and the segments that follow each path.
        covered: (P, 2) for each motion, the range of the path parameter that was followed.
        deviations: the deviations by step.
        speeds: speeds of moving frames by step.
        frames: for motions along paths of the moving frame, by row in the layout: a group of paths, and the
            index in the group.
        curves: paths in joint space, by row in the layout.
    """

    starts: Starts
    flows: Flows
    covered: Array
    deviations: dict[int, Deviation] = field(default_factory=dict)
    speeds: dict[int, ToolSpeed] = field(default_factory=dict)
    frames: dict[int, tuple[FramePaths, int]] = field(default_factory=dict)
    curves: dict[int, NaturalSpline] = field(default_factory=dict)


def law_of(judged: Judged, place: Place) -> tuple[Array, int] | None:
    """Return the path parameter over time (law) that the planner claims for a motion, and its first segment.

    The first segment is counted from the motion's own first segment. The law covers the motion's own segments
    and half of each blend's segments on either side. None without a usable claim.
    """
    law = judged.claims.laws.get(place.step)
    lead, trail = (place.before or 0) // 2, (place.behind or 0) // 2
    if law is None or law.shape != (place.size + lead + trail + 3,) or not np.isfinite(law).all():
        return None
    return law, -lead
