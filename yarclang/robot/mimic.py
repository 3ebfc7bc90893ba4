"""Describe joints that follow another joint by the URDF element <mimic>: their factor and offset, and how a
robot.toml expresses them.

Each joint of the chain has a motor of its own. The following joint may move with its leader while the motor
of the following joint is at rest. The coupling matrix J of robot.toml expresses this. Let q be the position
of the following joint and q' that of its leader: q = k q' + b, with factor k and offset b. In the
robot.toml's formula counts = K J q + a0, the row of the following joint in J is then (..., -k, ..., 1, ...),
and its a0 is -K b, so that its motor is at count 0 if q = k q' + b.
"""

from __future__ import annotations

from collections.abc import Sequence

from yarclang.frozen import frozen
from yarclang.robot.urdf import Joint
from yarclang.units import DEG, MM


@frozen
class Mimic:
    """A joint of the chain that follows another joint, its leader: `joint` = `factor` * `leader` + `offset`,
    in deg and mm.

    Attributes:
        joint: the joint that follows.
        leader: name of the leader.
        factor: factor of the leader's position.
        offset: offset [deg or mm].
        raw: multiplier and offset of the URDF, in rad and m.
        leader_kind: type of the leader; None if the URDF doesn't have the leader.
    """

    joint: Joint
    leader: str
    factor: float
    offset: float
    raw: tuple[float, float]
    leader_kind: str | None

    @property
    def equation(self) -> str:
        """The equation of the two joint positions with its units, and the values in the URDF."""
        unit = "mm" if self.leader_kind == "prismatic" else "deg"
        own = "mm" if self.joint.kind == "prismatic" else "deg"
        sign = "-" if self.offset < 0.0 else "+"
        multiplier, offset = self.raw
        return (
            f"{self.joint.name} [{own}] = {self.factor:.12g} * {self.leader[:40]} [{unit}] {sign} "
            f"{abs(self.offset):.12g} "
            f"(multiplier {multiplier:.12g}, offset {offset:.12g})"
        )

    def remedy(self, chain: Sequence[Joint]) -> str:
        """Return a sentence that explains how robot.toml expresses the coupling, or that robot.toml can't
        express it because the leader isn't in the chain.
        """
        name = self.joint.name
        if self.leader not in (joint.name for joint in chain) or self.leader == name:
            return (
                f"{self.leader[:40]} isn't another joint of the chain, so robot.toml can't describe "
                "this coupling."
            )
        return (
            f"If {name} has its own motor, which is at rest while {name} follows, remove <mimic> and give "
            f"{name} limits; in robot.toml its row of J is {-self.factor + 0.0:.12g} for {self.leader}, 1 "
            f"for {name} and 0 else, and its a0 is {-self.offset + 0.0:.12g} * K counts."
        )


def mimic_of(joint: Joint, joints: Sequence[Joint]) -> Mimic | None:
    """Return the <mimic> of a joint, or None if it has none.

    Args:
        joint: a joint of a URDF without errors.
        joints: all joints of the URDF, among which the leader is looked up.
    """
    element = joint.element.first("mimic")
    if element is None:
        return None
    leader = element.attributes.get("joint", "")
    kind = next((one.kind for one in joints if one.name == leader), None)
    multiplier, offset = (
        float(element.attributes.get(key, default)) for key, default in (("multiplier", "1"), ("offset", "0"))
    )
    own, lead = (MM if one == "prismatic" else DEG for one in (joint.kind, kind))
    return Mimic(joint, leader, multiplier * lead / own, offset / own, (multiplier, offset), kind)
