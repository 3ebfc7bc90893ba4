"""Planes between bodies prove distances, and bodies that are too close are refused.

Samples of Pinocchio and coal never have a smaller distance than the proved one.
"""

import copy
import functools
import operator
import random
from itertools import pairwise

import numpy as np
import pytest
from programs import robot_of

from tests.collision.dense import Dense
from tests.collision.test_proof import ROBOTS, drawn
from tests.verify.proof_forging import MOTIONS, made, refused, table
from tests.verify.test_forged_proofs import VALUES, parts
from yarclang.certify.bodies.second import nearest, seen
from yarclang.certify.kinematics.arm import KINEMATICS, steps_of
from yarclang.certify.pmac.proof.planes import planes_of
from yarclang.certify.pmac.proof.room import During, Room, exactly, told_arm
from yarclang.collision.zones.watched import tool_frame
from yarclang.verify.apart import PARTS, Timeline, check_apart
from yarclang.verify.arm import Arm
from yarclang.verify.course import Moved
from yarclang.verify.exact import ONE, RefusedError
from yarclang.verify.reader import PRINTED, STEPS, Entry
from yarclang.verify.room import Room as ToldRoom

CASES = 24


def numbered(names):
    """Return each name with its number among equal names."""
    return [(name, names[:at].count(name)) for at, name in enumerate(names)]


class Case:
    """A random cell with two commands in one sequence, and one command in another sequence."""

    def __init__(self, seed):
        self.random = np.random.default_rng(seed)
        self.robot = robot_of(ROBOTS[seed % 2])
        cell = drawn(self.random)
        self.rows = [*self._sequence(0, parted=True), *self._sequence(1, parted=False)]
        around = During(cell, tool_frame(self.robot))
        room = Room({row.entry.step: around for row in self.rows}, self.robot)
        self.cell, self.items = room.told, room.items
        self.arm = Arm(exactly(told_arm(self.robot)))
        self.dense = Dense(self.robot, cell)

    def _sequence(self, run, *, parted):
        robot, size = self.robot, int(self.random.integers(4, 30))
        ends = self.random.uniform(robot.limits.lower, robot.limits.upper, (2, robot.size)) * 0.6
        way = ends[0] + np.linspace(0, 1, size)[:, None] * (ends[1] - ends[0])
        way = (way + self.random.normal(0, 0.01, way.shape)) / robot.axis_units
        points = [tuple(int(one) for one in np.round(point * PRINTED)) for point in way]
        control = [points[0]] * 3 + points + [points[-1]] * 2
        steps = int(self.random.uniform(0.5, 5) / (len(points) + 2) * STEPS * 1000)
        cuts = [0, size // 2, size + 2] if parted else [0, size + 2]
        for first, last in pairwise(cuts):
            entry = Entry(2 * run + (first > 0), "MOVEJ", 1, 1, None, False)
            yield Moved(entry, points[0], points[-1], control, steps, first, last, None, run)

    def joints(self, begin, end, count):
        """Return `count` joint positions [rad or m] between two places of the timeline."""
        found = []
        segments = [(row, k) for row in self.rows for k in range(row.first, row.last)]
        for place in np.linspace(begin / PARTS, end / PARTS, count):
            row, k = segments[min(int(place), len(segments) - 1)]
            t = place - min(int(place), len(segments) - 1)
            c = np.array(row.control[k : k + 4], dtype=np.float64) / PRINTED * self.robot.axis_units
            weights = [(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3]
            found.append(np.array(weights) @ c / 6.0)
        return np.array(found)

    def nearest(self, begin, end, count):
        """Return the smallest sampled distance of each two bodies between two places of the timeline.

        A body is given by its name and its number among bodies of this name.
        """
        apart = self.dense.distances(self.joints(begin, end, count)).min(axis=0)
        objects, links = self.dense.geometry.geometryObjects, self.dense.links
        # Pinocchio appends a number to a link's name
        keys = numbered(
            [*(one.name.rsplit("_", 1)[0] for one in objects[:links]), *(one.name for one in objects[links:])]
        )
        pairs = zip(self.dense.pairs, apart.tolist(), strict=True)
        return {frozenset((keys[one], keys[other])): distance for (one, other), distance in pairs}

    def planes(self):
        return exactly(planes_of(self.rows, self.cell, self.items, self.robot, ()))

    def checked(self, planes, cell=None):
        return check_apart(self.rows, exactly(cell or self.cell), copy.deepcopy(planes), self.arm, ())


def left_out(one, other, said):
    """Return True if the checker says that it wasn't shown what keeps two bodies apart."""
    return f"that {one} keeps away from {other}" in said or f"that {other} keeps away from {one}" in said


@pytest.mark.parametrize("seed", range(CASES))
def test_no_gap_is_larger_than_a_distance(seed):
    """Any plane gives a lower bound of the distance, even one that isn't between the bodies."""
    case = Case(seed)
    timeline, told = Timeline(case.rows, case.arm), exactly(case.cell)
    travel = np.abs(np.concatenate([row.control for row in case.rows]).astype(np.float64)).max(axis=0)
    far = [int(one) + 1 for one in travel * case.robot.axis_units / PRINTED * ONE]
    room = ToldRoom(told, case.arm, far, ())
    bodies, pairs = room.bodies, [pair for pair in room.pairs(timeline.steps) if pair.needs]
    keys = numbered([body.name for body in bodies])
    seen = useful = 0
    for _ in range(12):
        begin, end = sorted(case.random.choice(timeline.count * PARTS, 2, replace=False).tolist())
        if case.random.random() < 0.5:
            end = min(end, begin + int(case.random.integers(1, 3 * PARTS)))
        nearest = case.nearest(begin, end, 40)
        for is_curve in (False, True):
            try:
                stretch = timeline.stretch(begin, end, is_curve)
            except RefusedError:
                assert is_curve
                continue
            for number in case.random.choice(len(pairs), min(len(pairs), 12), replace=False).tolist():
                pair = pairs[number]
                one, other = bodies[pair.one], bodies[pair.other]  # there are no zones
                normal = exactly(case.random.integers(-9, 10, 3).tolist())
                if not any(normal):
                    continue
                gap = stretch.gap(one, other, normal) / ONE
                distance = max(nearest[frozenset((keys[pair.one], keys[pair.other]))], 0.0)
                assert gap <= distance + 1e-6, (one.name, other.name)
                seen, useful = seen + 1, useful + (gap > 0.0)
    assert seen > 100
    assert useful > 3


@pytest.mark.parametrize("seed", range(CASES))
def test_what_keeps_apart_is_proved_and_a_wider_margin_is_not(seed):
    case = Case(seed)
    whole = Timeline(case.rows, case.arm).count * PARTS
    nearest = case.nearest(0, whole, 400)
    planes = case.planes()
    left = " ".join(case.checked(planes)[1])
    margins = {body["name"]: body["margin"] for body in case.cell["bodies"]}
    keys = numbered([body["name"] for body in case.cell["bodies"]])
    by_name = {}
    for pair, distance in nearest.items():
        names = frozenset(name for name, _ in pair)
        by_name[names] = min(distance, by_name.get(names, np.inf))
    for pair, distance in by_name.items():
        one, other = pair
        margin = max(margins[one], margins[other])
        named = left_out(one, other, left)
        assert not (named and distance > margin + 1e-4), (pair, distance)
        assert named or distance > margin - 1e-9, (pair, distance)
    # with a margin above the distance, the old planes are refused, and no others can be found
    tried = 0
    for pair, distance in sorted(nearest.items(), key=lambda one: one[1]):
        (one, _), (other, _) = pair
        if distance <= max(margins[one], margins[other]) + 1e-3 or tried == 2:
            continue
        changed = copy.deepcopy(case.cell)
        for at, key in enumerate(keys):
            if key in pair:
                changed["bodies"][at]["margin"] = distance + 1e-5
        with pytest.raises(RefusedError, match="isn't shown to keep away"):
            case.checked(planes, changed)
        found = exactly(planes_of(case.rows, changed, case.items, case.robot, ()))
        left = " ".join(case.checked(found, changed)[1])
        assert left_out(one, other, left)
        tried += 1


def found_without(case, planes):
    """Return what is unchecked with these planes, or why they are refused."""
    try:
        return case.checked(planes)[1]
    except RefusedError as error:
        return str(error)


def test_each_plane_is_needed():
    case = next(one for one in map(Case, range(20)) if len(one.planes()) > 8)
    planes = case.planes()
    _, left = case.checked(planes)
    for number in range(len(planes)):
        changed = [one for at, one in enumerate(planes) if at != number]
        assert found_without(case, changed) != left


@pytest.mark.parametrize(
    "forged",
    [
        [[0, 64, 0, [10_000, 1, 0, 0]]],
        [[0, 64, 0, [0, 0, 0, 0]]],
        [[64, 0, 0, [0, 1, 0, 0]]],
        [[-64, 64, 0, [0, 1, 0, 0]]],
        [[0, 10**9, 0, [0, 1, 0, 0]]],
        [[0.5, 64, 0, [0, 1, 0, 0]]],
        [[0, 64, 2, [0, 1, 0, 0]]],
        [[0, 64, 0, [0, 0.5, 0, 0]]],
        [[0, 64, 0, [-1, 1, 0, 0]]],
    ],
)
def test_planes_of_nothing_are_refused(forged):
    with pytest.raises(RefusedError):
        Case(0).checked(exactly(forged))


def test_a_curve_across_a_rest_is_refused():
    """A curve can't continue across a rest between two sequences, which may take any time."""
    case = Case(0)
    whole = Timeline(case.rows, case.arm).count * PARTS
    with pytest.raises(RefusedError, match="sequence"):
        case.checked(exactly([[0, whole, 1, [0, 0, 0, 1]]]))


def test_bodies_are_there_when_they_are():
    """A body that exists only during some commands counts only during these."""
    case = Case(2)
    far = {"name": "EVERYWHERE", "joint": 0, "margin": 0, "core": [9, 9, 9], "disc": 0, "radius": 0}
    far["pose"] = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]
    for steps, count in (([1, 1], 1), ([0, 1], 2)):
        cell = copy.deepcopy(case.cell)
        cell["bodies"].append(far | {"during": [steps]})
        told = exactly(cell)
        room = ToldRoom(told, case.arm, [0] * len(case.arm.turns), ())
        timeline = Timeline(case.rows, case.arm)
        pairs, added = room.pairs(timeline.steps), room.count - 1
        needs = [pair.needs for pair in pairs if pair.one == added]
        begins = timeline.begins
        wanted = {1: begins[1], 2: 0}[count]
        assert needs
        assert all(need == [(wanted * PARTS, begins[2] * PARTS, 0)] for need in needs)
        _, left = case.checked([], cell)
        assert any("EVERYWHERE" in one for one in left)
    cell["bodies"][-1]["during"] = [[7, 9]]
    with pytest.raises(RefusedError, match="commands without moves"):
        case.checked([], cell)


@pytest.mark.parametrize("seed", range(0, CASES, 2))
def test_no_point_of_a_body_is_faster_than_its_bound(seed):
    """The speed bound of a slow zone holds for all corners of a body.

    The corners' speeds are differences in time of the judge's placements.
    """
    case = Case(seed)
    timeline, told = Timeline(case.rows, case.arm), exactly(case.cell)
    travel = np.abs(np.concatenate([row.control for row in case.rows]).astype(np.float64)).max(axis=0)
    far = [int(one) + 1 for one in travel * case.robot.axis_units / PRINTED * ONE]
    room = ToldRoom(told, case.arm, far, ())
    bodies = room.bodies[: room.count]  # without the placeholder of conditions on joints alone
    sharp = 0
    for _ in range(8):
        begin = int(case.random.integers(0, timeline.begins[1] * PARTS - PARTS))
        end = begin + int(case.random.integers(1, PARTS))
        stretch = timeline.stretch(begin, end, is_curve=True)
        row = case.rows[0]
        step = 1e-4  # of a segment
        at = np.linspace(begin / PARTS + step, end / PARTS - step, 15)
        q = [case.joints((one - step) * PARTS, (one + step) * PARTS, 2) for one in at]
        for body, item in zip(bodies, case.items, strict=True):
            if body.joint == 0:
                continue
            speed = stretch.speed(body) / ONE
            most = 0.0
            for pair in q:
                placed = KINEMATICS.placements(case.robot.chain, pair)[body.joint]
                points = np.einsum("ijp,vj->pvi", placed[:, :3], item.points) + placed[:, 3].T[:, None]
                moved = np.linalg.norm(points[1] - points[0], axis=1).max()
                most = max(most, float(moved) / (2 * step * float(row.seconds)))
            assert most <= speed * (1 + 1e-6) + 1e-6, body.name
            sharp += most > 0.9 * speed
    assert sharp > 5


@pytest.mark.parametrize("seed", range(CASES))
def test_where_bodies_pass_no_gap_is_larger_than_the_distance(seed):
    """Planes are tried between bodies at their closest, where bounds are sharp."""
    case = Case(seed)
    timeline, told = Timeline(case.rows, case.arm), exactly(case.cell)
    travel = np.abs(np.concatenate([row.control for row in case.rows]).astype(np.float64)).max(axis=0)
    far = [int(one) + 1 for one in travel * case.robot.axis_units / PRINTED * ONE]
    room = ToldRoom(told, case.arm, far, ())
    pairs = [pair for pair in room.pairs(timeline.steps) if pair.needs]
    ends = (0, timeline.begins[2] * PARTS - 1)  # the first sequence, except its last instant
    places = np.linspace(*ends, 120)
    placed = KINEMATICS.placements(case.robot.chain, case.joints(*ends, len(places)))
    links = [np.eye(4)]
    for step in steps_of(case.robot.chain)[:-1]:
        links.append(links[-1] @ step)
    sharp = 0
    for pair in pairs:
        one, other = case.items[pair.one], case.items[pair.other]
        toward, distance = nearest(one, other, seen(placed, one.joint, other.joint, np.arange(len(places))))
        least = int(np.argmin(distance))
        if distance[least] <= 1e-3:
            continue
        normal = exactly(np.round(links[one.joint][:3, :3].T @ toward[:, least] * 1e6).astype(int).tolist())
        middle = int(places[least])
        for long in (8, 40, 160, 640):
            for begin, end in (
                (middle - long, middle + long),
                (middle, middle + long),
                (middle - long, middle),
            ):
                if begin < ends[0] or end > ends[1]:
                    continue
                there = KINEMATICS.placements(case.robot.chain, case.joints(begin, end, 9))
                _, apart = nearest(one, other, seen(there, one.joint, other.joint, np.arange(9)))
                for is_curve in (False, True):
                    stretch = timeline.stretch(begin, end, is_curve)
                    first, second = room.bodies[pair.one], room.bodies[pair.other]
                    gap = stretch.gap(first, second, normal) / ONE
                    assert gap <= apart.min() + 2e-6, (first.name, second.name, long, is_curve)
                    sharp += gap > apart.min() - 1e-3
    assert sharp >= 5


def test_a_body_is_no_point():
    """A body that has a size can't be declared as a point."""
    text, _ = made(MOTIONS)
    for at in range(len(table(MOTIONS, bodies=True)["cell"]["bodies"])):
        proof = table(MOTIONS, bodies=True)
        proof["cell"]["bodies"][at]["point"] = True
        assert "a point that has a size" in refused(text, proof)


def test_whatever_is_told_of_bodies_is_judged_without_a_traceback():
    """Random values in bodies, exceptions, zones and planes are refused or followed, and never raise."""
    text, _ = made(MOTIONS)
    draw, refusals = random.Random(34), 0
    for _ in range(60):
        proof = table(MOTIONS, bodies=True)
        proof["motions"] = {}
        proof["cell"]["zones"] = [copy.deepcopy(ZONE)]
        places = [place for place in parts(proof) if place[0] in ("cell", "planes")]
        for _ in range(draw.choice((1, 1, 2))):
            *outer, name = draw.choice(places)
            try:
                functools.reduce(operator.getitem, outer, proof)[name] = draw.choice(VALUES)
            except (KeyError, IndexError, TypeError):
                continue  # an earlier change has removed this place
        refusals += bool(refused(text, proof))
    assert refusals > 30


ZONE = {
    "name": "Z",
    "rule": "allowed",
    "margin": 0,
    "watched": [0],
    "region": {"pose": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0], "core": [9, 9, 9], "disc": 0, "radius": 0},
}
