"""Choose the chain of a URDF's joints that is the arm: its base, its tip, and the joints that don't belong
to it.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from yarclang.diagnostics import Diagnostic
from yarclang.frozen import frozen
from yarclang.robot.chain import find_links, joints_between
from yarclang.robot.mimic import mimic_of
from yarclang.robot.urdf import MOVING, UNARMED, Joint, Urdf
from yarclang.source import SourceFile

FINGERS = re.compile(r"finger|gripper|thumb|knuckle|jaw|claw", re.IGNORECASE)
"""Pattern of joint names that belong to a hand, not to an arm."""

LONGEST_HAND = 4
"""Largest number of joints of a finger. If an arm splits and none of its branches has more joints, the
branches count as fingers.
"""

MOST_ARMS = 3
"""If an arm splits into more branches than this, the branches count as fingers, however long they are."""

DEEPEST = 100
"""The largest number of joints, fixed ones included, from the root to a tip."""

SHORTEST_ARM = 3
"""Smallest number of joints before a split at which the branches may count as fingers."""

HANDS = re.compile(
    r"gripper|robotiq|schunk|onrobot|finger|hand(?!le)|palm|wsg|suction|vacuum|cup|jaw|claw|torch|spindle"
    r"|welder|eoat|camera|sensor|_sc$",
    re.IGNORECASE,
)
"""Pattern of names of links that are mounted on a flange, or are a second shape of the last link."""

_FLANGE_NAMES = (r"(^|_)tool0$", r"(^|_)flange(_link|_frame)?$", r"flange", r"ee_link|link_ee|end_effector")
"""Patterns of names of flanges, the best first. By REP 199, z of the link tool0 points out along the tool, as
PICKPLACE and PALLET require; in the link flange, x points out along the tool.
"""

_TCP_NAMES = (r"tcp|grasp|tool_tip",)


@frozen
class ArmChain:
    """The chain of a URDF that is proposed as the arm.

    Attributes:
        base: the link that is {B}.
        flange: the link that is {FLANGE}.
        joints: the moving joints between them, from the base to the flange.
        tcp: a link fixed to the flange whose name denotes the tool's tip; empty for none.
        base_choices: other links that could be the base, since they are fixed to it.
        flange_choices: other links that could be the flange, since they are fixed to it.
        other_tips: the tips of other chains of the same length.
        ignored: the moving joints that aren't in the chain.
        fingers: ignored joints that move a gripper on the tip.
        followers: ignored joints that follow another joint by <mimic>: rods, counterweights.
        left_out: joints outside the chain that have motors and form a limb as large as an arm.
    """

    base: str
    flange: str
    joints: tuple[Joint, ...]
    tcp: str
    base_choices: tuple[str, ...]
    flange_choices: tuple[str, ...]
    other_tips: tuple[str, ...]
    ignored: tuple[str, ...]
    fingers: tuple[str, ...]
    followers: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()

    def incomplete(self, source: SourceFile) -> Diagnostic:
        """Return the finding about limbs (such as a second arm) that are as large as an arm, but not in
        the chain.
        """
        names = f"{', '.join(self.left_out[:6])}{', ...' * (len(self.left_out) > 6)}"
        message = (
            f"the chain from {self.base} to {self.flange} has {len(self.joints)} joints and omits "
            f"{len(self.left_out)} joints with their own motors: {names}"
        )
        ends = f" (or {', '.join(self.other_tips[:4])})" if self.other_tips else ""
        remedy = f"Choose the arm with --tip: {self.flange}{ends}, or a later link."
        return Diagnostic("Y1365", message, source, help=remedy)


def find_chain(urdf: Urdf, base: str | None = None, tip: str | None = None) -> ArmChain | Diagnostic:
    """Find the arm in a URDF: the longest serial chain of joints, or the chain between two links.

    The chain leaves out five kinds of joints: joints after a link called tool0, which belong to a tool;
    joints whose names denote fingers; joints on the tip that other joints mimic; the branches into which an
    arm splits at its end; and joints that mimic another joint. If a mimicking joint carries the rest of the
    arm, the arm's joints are coupled: the result is then a finding instead of a chain. Of several chains with
    equally many joints, the first one of the file is chosen.

    Args:
        urdf: a URDF whose links form one tree.
        base: the link to begin with, or None.
        tip: the link to end with, or None.
    """
    tree = _Tree(urdf, FINGERS)
    lost = find_links(urdf, {key: link for key, link in (("--base", base), ("--tip", tip)) if link})
    if lost:
        _, message, remedy, subject = lost[0]
        return Diagnostic("Y1347", message, urdf.source, help=remedy, subject=subject)
    if deepest := tree.deeper_than(DEEPEST):
        message = f"link {deepest[:40]} is more than {DEEPEST} joints below the root"
        return Diagnostic("Y1353", message, urdf.source, help="Keep only the arm and the bodies on it.")
    base_given = base is not None
    others: tuple[str, ...] = ()
    if tip is None:
        starts = [base] if base else tree.starts()
        paths = [path for start in starts for path in tree.arms(start)]
        if not paths:  # perhaps the names of all joints denote fingers
            tree = _Tree(urdf, None)
            paths = [path for start in starts for path in tree.arms(start)]
        longest = max((len(path) for path in paths), default=0)
        if longest == 0:
            remedy = "Name the arm's foot and its end with --base and --tip; fingers don't count as an arm."
            message = "the URDF has no chain of moving joints that could be an arm"
            return Diagnostic("Y1353", message, urdf.source, help=remedy)
        best = [path for path in paths if len(path) == longest]
        others = tuple(tree.flange_of(path[-1].child)[0] for path in best[1:])
        first, last = best[0][0].parent, best[0][-1].child
        flange, flange_choices = tree.flange_of(last)
    else:
        flange, flange_choices = tip, ()
        first = base or tree.foot_of(tip)
    if base is None:
        base, base_choices = tree.base_of(first)
    else:
        base_choices = ()
    between = joints_between(urdf, base, flange)
    joints = tuple(joint for joint in between or () if joint.kind in MOVING)
    if not joints:
        message = f"no chain of moving joints leads from the base {base} to the tip {flange}"
        back = joints_between(urdf, flange, base)
        remedy = "Swap --base and --tip." if back else "Name a link above the tip with --base."
        return Diagnostic("Y1353", message, urdf.source, help=remedy)
    followed = (mimic_of(joint, tuple(urdf.joints.values())) for joint in joints)
    coupled = next((one for one in followed if one is not None), None)
    if coupled is not None:
        message = (
            f"joint {coupled.joint.name} is between the base {base} and the tip {flange} and follows "
            f"another joint by <mimic>, {coupled.equation}"
        )
        remedy = f"Name a link above it with --tip {coupled.joint.parent}. {coupled.remedy(joints)}"
        return Diagnostic("Y1353", message, urdf.source, help=remedy)
    inside = {joint.name for joint in between or ()}
    ignored = tuple(j.name for j in urdf.joints.values() if j.kind != "fixed" and j.name not in inside)
    on_tip = {joint.name for joint in tree.below_of(joints[-1].child)}
    fingers = tuple(name for name in ignored if name in on_tip)
    tcp = tree.tcp_of(flange)
    followers = tuple(name for name in ignored if name in tree.leaders and name not in on_tip)
    left_out = (
        ()
        if tip
        else (*tree.limbs(inside | on_tip, len(joints)), *(() if base_given else tree.driven_above(base)))
    )
    return ArmChain(
        base,
        flange,
        joints,
        tcp,
        base_choices,
        flange_choices,
        tuple(dict.fromkeys(others)),
        ignored,
        fingers,
        followers,
        left_out,
    )


class _Tree:
    """The links of a URDF with the joints above and below each of them."""

    def __init__(self, urdf: Urdf, fingers: re.Pattern[str] | None) -> None:
        self.fingers = fingers
        self.below: dict[str, list[Joint]] = {link: [] for link in urdf.links}
        self.above: dict[str, Joint] = {}
        self._moving: dict[str, list[Joint]] = {}
        self.leaders: dict[str, str] = {}  # the joint that each mimic joint follows
        for joint in urdf.joints.values():
            self.below[joint.parent].append(joint)
            self.above[joint.child] = joint
            mimic = joint.element.first("mimic")
            if mimic is not None:
                self.leaders[joint.name] = mimic.attributes.get("joint", "")

    def deeper_than(self, most: int) -> str:
        """Return a link that is more than `most` joints below a root of the tree; empty if there is none."""
        row = [link for link in self.below if link not in self.above]
        for _ in range(most + 1):
            row = [joint.child for link in row for joint in self.below[link]]
        return next(iter(row), "")

    def starts(self) -> list[str]:
        """Return the links at which an arm may begin: the roots of the tree, and links below a planar or
        floating joint, by which a URDF lets a vehicle move.
        """
        roots = [link for link in self.below if link not in self.above]
        return roots + [joint.child for joint in self.above.values() if joint.kind in UNARMED]

    def body(self, link: str) -> list[str]:
        """Return the links that form one rigid body with `link`: `link` itself, and the links below it that
        fixed joints connect to it.
        """
        found = [link]
        for name in found:
            found += [joint.child for joint in self.below[name] if joint.kind == "fixed"]
        return found

    def moving(self, link: str) -> list[Joint]:
        """Return the joints that move the next part of an arm relative to the rigid body of `link`.

        These are joints with a motor, and mimicking joints that carry a joint with a motor or the flange.
        """
        if link not in self._moving:
            joints = [joint for name in self.body(link) for joint in self.below[name] if joint.kind in MOVING]
            self._moving[link] = [
                joint
                for joint in joints
                if not (self.fingers and self.fingers.search(joint.name))
                and (self.carries(joint) if joint.name in self.leaders else not self.grips(joint, joints))
            ]
        return self._moving[link]

    def carries(self, joint: Joint) -> bool:
        """Return True if the arm continues after a joint: with another moving joint, or with a link that has
        a flange's name.
        """
        return bool(_named(self.body(joint.child), _FLANGE_NAMES) or self.moving(joint.child))

    def grips(self, joint: Joint, beside: Sequence[Joint]) -> bool:
        """Return True if a joint carries only fingers of a gripper: no moving joint comes after it, and
        joints beside it or below it mimic it.
        """
        if joint.name not in self.leaders.values():
            return False
        near = {other.name for other in (*beside, *self.below_of(joint.child))}
        follow = any(leader == joint.name and name in near for name, leader in self.leaders.items())
        return follow and not self.carries(joint)

    def limbs(self, inside: Collection[str], size: int) -> tuple[str, ...]:
        """Return the joints of limbs outside a chain of `size` joints, such as a second arm. A limb has at
        least `SHORTEST_ARM` joints, or at least `size` joints if the chain is shorter than this.
        """
        paths = [path for start in self.starts() for path in self.arms(start)]
        outside = [[joint.name for joint in path if joint.name not in inside] for path in paths]
        long = [names for names in outside if len(names) >= min(SHORTEST_ARM, size)]
        return tuple(dict.fromkeys(name for names in long for name in names))

    def driven_above(self, link: str) -> tuple[str, ...]:
        """Return the joints with motors above a link, those nearest to the root first. If `link` is the arm's
        base, these joints move the base, and only a planar or floating joint separates them from the arm.
        """
        joints = []
        while link in self.above:
            if self.above[link].kind in MOVING and self.above[link].name not in self.leaders:
                joints.append(self.above[link].name)
            link = self.above[link].parent
        return tuple(reversed(joints))

    def depth(self, link: str) -> int:
        """Return the largest number of moving joints in a chain that begins at `link`."""
        return max((1 + self.depth(joint.child) for joint in self.moving(link)), default=0)

    def arms(self, link: str, path: tuple[Joint, ...] = ()) -> list[tuple[Joint, ...]]:
        """Return all chains of moving joints from `link` to a tip, without the fingers at the tip."""
        ways = self.moving(link)
        splits = len(ways) > 1 and self.depth(link) <= LONGEST_HAND
        ends = self.depth(link) <= LONGEST_HAND and _named(self.body(link), _FLANGE_NAMES[:1])
        hand = len(path) >= SHORTEST_ARM and (splits or len(ways) > MOST_ARMS or ends)
        if hand or not ways:
            return [path] if path else []
        return [arm for joint in ways for arm in self.arms(joint.child, (*path, joint))]

    def flange_of(self, link: str) -> tuple[str, tuple[str, ...]]:
        """Return the flange after the last moving link of a chain, and other links that could be the flange.

        The flange is chosen by name. If no name fits, the flange is the only link that is fixed to the last
        moving link and doesn't belong to a hand. If there are several such links or none, the flange is the
        last moving link.
        """
        body = self.body(link)
        named = _named(body, _FLANGE_NAMES)
        fixed = [joint.child for joint in self.below[link] if joint.kind == "fixed"]
        fixed = [name for name in fixed if not (HANDS.search(name) or self.holds(name))]
        flange = named or (fixed[0] if len(fixed) == 1 else link)
        return flange, tuple(name for name in body if name != flange)

    def holds(self, link: str) -> bool:
        """Return True if a moving joint begins at the link itself, as at the base of a gripper."""
        return any(joint.kind in MOVING for joint in self.below[link])

    def tcp_of(self, flange: str) -> str:
        """Return the link fixed to the flange whose name denotes the tool's tip; empty if there is none."""
        return _named(self.body(flange)[1:], _TCP_NAMES)

    def base_of(self, link: str) -> tuple[str, tuple[str, ...]]:
        """Return the base above the first moving joint of a chain, and other links that could be the base.

        The base is chosen by name; if no name fits, it is the parent link of that joint.
        """
        body = [link]
        while body[-1] in self.above and self.above[body[-1]].kind == "fixed":
            body.append(self.above[body[-1]].parent)
        base = _named(body, (r"^base_link$", r"base")) or link
        return base, tuple(name for name in body if name != base)

    def foot_of(self, tip: str) -> str:
        """Return the parent link of the first moving joint of the chain that ends at `tip`. Joints by which a
        vehicle moves don't count.
        """
        first = here = tip
        while here in self.above and self.above[here].kind not in UNARMED:
            if self.above[here].kind in MOVING:
                first = self.above[here].parent
            here = self.above[here].parent
        return first

    def below_of(self, link: str) -> list[Joint]:
        """Return all joints below `link`."""
        found = list(self.below[link])
        for joint in found:
            found += self.below[joint.child]
        return found


def _named(links: Sequence[str], patterns: Sequence[str]) -> str:
    """Return the first link whose name matches a pattern; empty if no name matches. Patterns are tried in the
    order of preference.
    """
    for pattern in patterns:
        for link in links:
            if re.search(pattern, link, re.IGNORECASE):
                return link
    return ""
