"""Comparison of a program's poses with the numbers that its author wrote, by the judge's own transforms."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from yarclang import hir
from yarclang.cell.keeping import Height, Keep, Sight, Tilt
from yarclang.cell.model import Cell, HalfSpace, Mount, ShapeRegion
from yarclang.certify.kinematics.rotations import of_numbers
from yarclang.robot.model import Array, Robot

SAME = 1e-9
"""Largest difference between entries of two transforms that count as equal [m].

If a coordinate of a frame is larger than 1 m, the limit is multiplied by the largest coordinate in metres.
"""


def wrong_poses(program: hir.Program, robot: Robot) -> Iterator[tuple[int | None, str]]:
    """Yield the poses that differ from the numbers that their author wrote, each as its step and a reason.

    The step is None for a body, a frame or a zone of the cell.

    Args:
        program: the program.
        robot: the robot as the judge reads it.
    """
    frames = _Frames(robot)
    given: dict[int, list[tuple[int, hir.PoseGoal | hir.PoseDelta, hir.Told]]] = {}
    for step, motion in enumerate(program.steps):
        if not isinstance(motion, hir.Motion):
            continue
        for goal in motion.goals:
            if isinstance(goal, hir.PoseGoal | hir.PoseDelta) and goal.told is not None:
                given.setdefault(len(goal.told.numbers), []).append((step, goal, goal.told))
        yield from ((step, reason) for reason in frames.wrong(motion.origin.tool))
        yield from ((step, reason) for reason in frames.wrong_rules(motion.keeps))
    for group in given.values():
        written = of_numbers(np.array([told.numbers for *_, told in group]))
        bases = np.array([frames.placed(told.base) for *_, told in group])
        moving = np.array([frames.placed(told.moving) for *_, told in group])
        # Compare all goals of the group at once: first their moving frames, then absolute poses, then
        # increments.
        same = _are_all_one(np.array([goal.flange_from_moving for _, goal, _ in group]), moving)
        are_poses = np.array([isinstance(goal, hir.PoseGoal) for _, goal, _ in group])
        poses = [goal.base_from_moving for _, goal, _ in group if isinstance(goal, hir.PoseGoal)]
        if poses:
            same[are_poses] &= _are_all_one(np.array(poses), bases[are_poses] @ written[are_poses])
        deltas = [goal for _, goal, _ in group if isinstance(goal, hir.PoseDelta)]
        if deltas:
            asked, said, axes = (np.tile(np.eye(4), (len(deltas), 1, 1)) for _ in range(3))
            asked[:, :3, :3] = [goal.turn for goal in deltas]
            asked[:, :3, 3] = [goal.shift for goal in deltas]
            said[:, :3, :3] = [goal.axes for goal in deltas]
            axes[:, :3, :3] = bases[~are_poses, :3, :3]
            same[~are_poses] &= _are_all_one(asked, written[~are_poses]) & _are_all_one(said, axes)
        for place in np.flatnonzero(~same).tolist():
            yield (
                group[place][0],
                (
                    "its pose isn't the one that was written: frame, position or rotation were converted "
                    "wrongly"
                ),
            )
    if program.cell is not None:
        yield from ((None, reason) for reason in _wrong_places(program.cell, robot))


class _Frames:
    """Frames computed from the numbers of their declarations. Each frame is computed once."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._placed: dict[int, tuple[hir.FrameLink, Array]] = {}
        self._seen: set[int] = set()
        self._checked: dict[int, Keep] = {}

    def placed(self, link: hir.FrameLink) -> Array:
        """Return base_from_frame or flange_from_frame (4, 4)."""
        known = self._placed.get(id(link))
        if known is not None:
            return known[1]
        if link.parent is None:
            pose = np.eye(4)
        elif link.told is None:
            pose = self.placed(link.parent) @ self._of_robot(link)
        else:
            pose = self.placed(link.parent) @ of_numbers(link.told)
        self._placed[id(link)] = link, pose
        return pose

    def _of_robot(self, link: hir.FrameLink) -> Array:
        own = self._robot.flange_from_frame.get(link.name)
        return link.parent_from_frame if own is None else own

    def wrong(self, link: hir.FrameLink | None) -> Iterator[str]:
        """Yield the faults of a frame and its parents, except of frames that were checked before."""
        while link is not None and id(link) not in self._seen:
            self._seen.add(id(link))
            self.placed(link)  # keeps a reference to the frame, so that no other object gets its id
            if link.parent is not None:
                own = self._of_robot(link) if link.told is None else of_numbers(link.told)
                if not _are_one(own, link.parent_from_frame):
                    yield f"the frame {{{link.name}}} isn't where its numbers put it"
            link = link.parent

    def wrong_rules(self, keeps: tuple[Keep, ...]) -> Iterator[str]:
        """Yield the faults of rules (KEEP) in words, except of rules that were checked before."""
        for keep in keeps:
            carried, standing = keep.carried, keep.standing
            if id(keep) in self._checked:
                continue
            self._checked[id(keep)] = keep
            if not isinstance(carried, hir.FrameLink) or not isinstance(standing, hir.FrameLink):
                yield f"the frames of KEEP {keep.words} aren't known"
                continue
            names = carried.name, standing.name
            if names != (keep.frame, keep.of) or not _is_region(
                keep, self.placed(carried), self.placed(standing)
            ):
                yield f"the frames of KEEP {keep.words} aren't where their numbers put them"


def _is_region(keep: Keep, carried: Array, standing: Array) -> bool:
    """Return True if the points and axes in a rule (KEEP) are those of the rule's two frames.

    Args:
        keep: the rule.
        carried: flange_from_frame (4, 4) [m] of the frame that the robot carries.
        standing: base_from_frame (4, 4) [m] of the frame that stands still.
    """
    pairs: list[tuple[tuple[float, ...], Array]]
    match keep.kind, keep.region:
        case "UPRIGHT", Tilt() as tilt:
            pairs = [(tilt.own, carried[:3, 2]), (tilt.up, standing[:3, 2])]
        case "ABOVE", Height() as height:
            level = standing[:3, 2] @ standing[:3, 3]
            pairs = [(height.own, carried[:3, 3]), (height.up, standing[:3, 2]), ((height.level,), level)]
        case (("FACING" | "SEEN"), Sight() as sight):
            if sight.is_carried != (keep.kind == "FACING") or not sight.near > 0.0:
                return False
            axis = carried[:3, 2] if sight.is_carried else standing[:3, 2]
            pairs = [(sight.own, carried[:3, 3]), (sight.spot, standing[:3, 3]), (sight.axis, axis)]
        case _:
            return False
    far = SAME * max(1.0, float(np.abs(standing[:3, 3]).max()), float(np.abs(carried[:3, 3]).max()))
    return all(bool((np.abs(np.array(one) - other) <= far).all()) for one, other in pairs)


def _wrong_cell_rules(cell: Cell, robot: Robot) -> Iterator[str]:
    """Yield the rules of a cell whose points and axes are not those of their frames in cell and robot."""
    for keep in cell.rules:
        placed = []
        for name, is_carried in ((keep.frame, True), (keep.of, False)):
            frame = cell.frames.get(name)
            if frame is not None:
                known = frame.mount.on_flange == is_carried
                own = frame.mount.transform if frame.mount.told is None else _followed(frame.mount.told)
                placed.append(own if known else None)
            elif not is_carried:
                placed.append(np.eye(4) if name == "B" else None)
            else:
                placed.append(np.eye(4) if name == "FLANGE" else robot.flange_from_frame.get(name))
        carried, standing = placed
        if carried is None or standing is None or not _is_region(keep, carried, standing):
            yield f"the frames of the rule {keep.words} of the cell aren't where their numbers put them"


def _wrong_places(cell: Cell, robot: Robot) -> Iterator[str]:
    """Yield the bodies, frames and zones of a cell that are not where their numbers put them."""
    bodies = [*cell.obstacles, *(part.body for part in cell.parts)]
    mounts: list[tuple[str, Mount]] = [(one.name, one.mount) for one in bodies]
    mounts += [(f"{{{name}}}", frame.mount) for name, frame in cell.frames.items()]
    placed = [(name, one.transform, one.told) for name, one in mounts]
    regions = ((one.name, one.region) for one in cell.zones)
    placed += [
        (f"zone {name}", region.base_from_shape, region.told)
        for name, region in regions
        if isinstance(region, ShapeRegion)
    ]
    for name, transform, told in placed:
        if told is None:
            continue
        written = _followed(told)
        if not _are_one(written, transform):
            yield f"{name} of the cell isn't where its numbers put it"
    for zone in cell.zones:
        border = zone.region
        if isinstance(border, HalfSpace) and border.told is not None and border.own_normal is not None:
            written = _followed(border.told)
            normal = written[:3, :3] @ border.own_normal / np.sqrt(border.own_normal @ border.own_normal)
            # The border's plane goes through the origin p of the zone's frame. With the frame's rotation R
            # and the border's own normal n, the half-space has the normal R n and the offset p . R n.
            off = np.append(normal - border.normal, normal @ written[:3, 3] - border.offset)
            if np.abs(off).max() > SAME * max(1.0, float(np.abs(written[:3, 3]).max())):
                yield f"the border of the zone {zone.name} isn't where its numbers put it"
    yield from _wrong_cell_rules(cell, robot)
    yield from _wrong_tools(cell, robot)
    for grip in cell.grips.values():
        frame = cell.frames.get(grip.frame)
        hangs = robot.flange_from_frame.get(grip.frame) if frame is None else frame.mount.transform
        if hangs is not None and not _are_one(grip.flange_from_grip, hangs):
            yield f"the gripper in {{{grip.frame}}} isn't where its frame is"


def _wrong_tools(cell: Cell, robot: Robot) -> Iterator[str]:
    """Yield the tools of a cell that differ from the numbers in cell.toml, or from the robot's tools."""
    known = {one.name: one for one in robot.tools}
    for part in cell.parts:
        rack, body = part.rack, part.body
        if rack is None:
            continue
        tool = known.get(body.name)
        if tool is None or tool.mounted or len(tool.shapes) != 1 + len(rack.more):
            yield f"the tool {body.name} of the cell isn't the robot's"
            continue
        if rack.place.told is not None and not _are_one(_followed(rack.place.told), rack.place.transform):
            yield f"the place of the tool {body.name} isn't where its numbers put it"
        first, *others = (one.flange_from_shape for one in tool.shapes)
        stands = first if body.mount.on_flange else rack.place.transform @ first
        placed = [(rack.flange_from_body, first), (body.mount.transform, stands)]
        placed += [(first @ own, other) for (own, _), other in zip(rack.more, others, strict=True)]
        if not all(_are_one(one, other) for one, other in placed):
            yield f"a body of the tool {body.name} isn't where its numbers put it"
        weight, turn = body.weight, first[:3, :3]
        if weight is None or abs((body.mass or 0.0) - tool.mass) > SAME * max(1.0, tool.mass):
            yield f"the tool {body.name} has another mass"
            continue
        # In another frame, given by rotation R and origin p, a centre of mass c becomes R c + p, and an
        # inertia tensor I becomes R I R'.
        off = np.abs(turn @ weight.center + first[:3, 3] - tool.center).max()
        off = max(off, np.abs(turn @ weight.inertia @ turn.T - tool.inertia).max())
        if off > SAME:
            yield f"the mass of the tool {body.name} isn't where its numbers put it"


def _followed(told: tuple[Array, ...]) -> Array:
    """Return the product (4, 4) of poses, each given relative to the one before."""
    own = np.eye(4)
    for numbers in told:
        own = own @ of_numbers(numbers)
    return own


def _are_one(one: Array, other: Array) -> bool:
    """Return True if two transforms (4, 4) are equal except for rounding."""
    return bool(_are_all_one(one[None], other[None])[0])


def _are_all_one(ones: Array, others: Array) -> NDArray[np.bool_]:
    """Return a mask (n,): True for each pair of transforms (n, 4, 4) that are equal up to rounding.

    A pair with a value that isn't finite is not equal.
    """
    allowed = SAME * np.maximum(1.0, np.abs(others[:, :3, 3]).max(axis=1))
    made: NDArray[np.bool_] = np.abs(ones - others).max(axis=(1, 2)) <= allowed
    return made
