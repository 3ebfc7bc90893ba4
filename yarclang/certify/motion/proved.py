"""What the proofs of a text's motions share."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from yarclang.certify.blends.corner import Judged, Starts
from yarclang.certify.blends.flows import Flows
from yarclang.certify.certificate import Deviation, ToolSpeed
from yarclang.certify.motion.programmed import FramePaths
from yarclang.certify.motion.spline import NaturalSpline
from yarclang.certify.read.layout import Place
from yarclang.robot.model import Array


@dataclass(slots=True, eq=False)
class Proofs:
    """What was proved of every motion, and about which path: by the motion's number among the motions, but `deviations` and
    `speeds` by its step.

    `frames` are paths of moving frames, each one of several; `curves` those in joint space. `covered` (P, 2) are the shares
    of the paths between which they were followed.
    """

    starts: Starts
    flows: Flows
    covered: Array
    deviations: dict[int, Deviation] = field(default_factory=dict)
    speeds: dict[int, ToolSpeed] = field(default_factory=dict)
    frames: dict[int, tuple[FramePaths, int]] = field(default_factory=dict)
    curves: dict[int, NaturalSpline] = field(default_factory=dict)


def law_of(judged: Judged, place: Place) -> tuple[Array, int] | None:
    """A claimed law that covers all of the command, with half of each blend's segments on either side."""
    law = judged.claims.laws.get(place.step)
    lead, trail = (place.before or 0) // 2, (place.behind or 0) // 2
    if law is None or law.shape != (place.size + lead + trail + 3,) or not np.isfinite(law).all():
        return None
    return law, -lead
