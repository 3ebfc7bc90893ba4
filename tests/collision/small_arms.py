"""Small random arms with shapes, in a cell: as URDF text, as read by yarclang, and as read by Pinocchio and
coal.
"""

from dataclasses import dataclass, replace
from functools import cache
from types import MappingProxyType

import coal
import numpy as np
import pinocchio as pin

from tests.collision.dense import shape_of
from tests.robot.made_arms import _numbers as numbers
from yarclang.robot.chain import joints_between, screws
from yarclang.robot.description import load_robot
from yarclang.robot.link_shapes import link_shapes
from yarclang.robot.model import Robot, Tool, ToolShape
from yarclang.robot.urdf import read_urdf
from yarclang.source import SourceFile

ARMS = 60
"""Number of different arms. Reading an arm takes longer than moving it, so each is used several times."""


def urdf_text(random, size):
    """Return the URDF of links of 0.1 to 0.5 m in a chain, each with one or two shapes."""
    lines = ['<robot name="small" version="1.1">', f'<link name="foot">{collision(random, 0.1)}</link>']
    above, length = "foot", 0.15
    for number in range(1, size + 1):
        kind = "prismatic" if random.random() < 0.2 else "revolute"
        axis = np.eye(3)[random.integers(3)] if random.random() < 0.7 else random.normal(size=3)
        turn = random.choice([0.0, np.pi / 2, -np.pi / 2], 3) + random.normal(0, 0.05, 3)
        place = f'<origin xyz="0 0 {length + 0.05:.4f}" rpy="{numbers(turn)}"/>'
        ends = (-0.3, 0.3) if kind == "prismatic" else (-3.0, 3.0)
        length = random.uniform(0.1, 0.5)
        shapes = "".join(collision(random, length) for _ in range(random.integers(1, 3)))
        lines += [
            f'<link name="L{number}">{shapes}</link>',
            f'<joint name="J{number}" type="{kind}"><parent link="{above}"/><child link="L{number}"/>{place}',
            (
                f'<axis xyz="{numbers(axis / np.linalg.norm(axis))}"/><limit lower="{ends[0]}" '
                f'upper="{ends[1]}" velocity="1" effort="1"/></joint>'
            ),
        ]
        above = f"L{number}"
    lines += ['<link name="flange"/><joint name="end" type="fixed">']
    lines += [
        f'<parent link="{above}"/><child link="flange"/><origin xyz="0 0 {length:.4f}"/></joint></robot>'
    ]
    return "\n".join(lines)


def collision(random, length):
    """Return a shape along a link."""
    thick = random.uniform(0.01, 0.08)
    shape = [
        f'<box size="{thick:.4f} {2 * thick:.4f} {length:.4f}"/>',
        f'<capsule radius="{thick:.4f}" length="{length:.4f}"/>',
        f'<cylinder radius="{thick:.4f}" length="{length:.4f}"/>',
        f'<sphere radius="{2 * thick:.4f}"/>',
    ][random.integers(4)]
    turn = numbers(random.normal(0, 0.2, 3))
    return (
        f'<collision><origin xyz="0 0 {length / 2:.4f}" '
        f'rpy="{turn}"/><geometry>{shape}</geometry></collision>'
    )


@dataclass(frozen=True, slots=True, eq=False)
class Arm:
    """An arm, and Pinocchio's reading of the same text."""

    robot: Robot
    text: str
    model: pin.Model
    geometry: pin.GeometryModel


@cache
def arm(number):
    """Return the arm with a number."""
    random = np.random.default_rng(number)
    text = urdf_text(random, 1 + number % 4)
    urdf = read_urdf(SourceFile("small.urdf", text))
    moving = joints_between(urdf, "foot", "flange")[:-1]
    chain = screws(urdf, "foot", "flange", moving)
    assert not urdf.findings
    like = load_robot("INDUSTRIAL6").value
    size = chain.size
    robot = replace(
        like,
        chain=chain,
        joint_names=like.joint_names[:size],
        shapes=link_shapes(urdf, like.folder, "foot", moving),
        positions=MappingProxyType({"HOME": np.zeros(size)}),
    )
    model = pin.buildModelFromXML(text)
    return Arm(robot, text, model, pin.buildGeomFromUrdfString(model, text, pin.GeometryType.COLLISION))


class Watched:
    """Pinocchio's geometry of an arm with tools on its flange, in a cell. Only the numbers of the cell come
    from yarclang.
    """

    def __init__(self, arm, cell, tools):
        self.model, self.geometry = arm.model, arm.geometry.copy()
        self.links = self.geometry.ngeoms
        frame = self.model.frames[self.model.getFrameId("flange", pin.FrameType.BODY)]
        self.margin, self.names = [0.0] * self.links, []
        for one in self.geometry.geometryObjects:
            self.names.append(self.model.frames[one.parentFrame].name)
        carried = [
            (tool.name, part.flange_from_shape, part.shape, 0.0) for tool in tools for part in tool.shapes
        ]
        for at, (name, placed, shape, margin) in enumerate(
            [*carried, *((one.name, one.mount.transform, one.shape, one.margin) for one in cell.obstacles)]
        ):
            on_arm = at < len(carried)
            pose = frame.placement * pin.SE3(placed) if on_arm else pin.SE3(placed)
            body = pin.GeometryObject(
                f"{name}{at}", frame.parentJoint if on_arm else 0, pose, shape_of(shape)
            )
            self.geometry.addGeometryObject(body)
            self.margin.append(margin)
            self.names.append(name)
        self.state = self.model.createData()
        self.pairs = self._pairs()
        for pair in self.pairs:
            self.geometry.addCollisionPair(pin.CollisionPair(*pair))
        self.data = self.geometry.createData()
        self.wanted = np.array([max(self.margin[at] for at in pair) for pair in self.pairs])
        self.called = [frozenset(self.names[at] for at in pair) for pair in self.pairs]
        self.of_cell = np.array(
            [any(name.startswith("O") for name in pair) for pair in self.called], dtype=bool
        )

    def _pairs(self):
        """Return the pairs that must not meet: no neighbours, and no links that touch in HOME."""
        bodies = self.geometry.geometryObjects
        pin.updateGeometryPlacements(
            self.model, self.state, self.geometry, data := self.geometry.createData(), np.zeros(self.model.nq)
        )
        pairs, home = [], set()
        for other in range(len(bodies)):
            for one in range(other):
                joints = sorted((bodies[one].parentJoint, bodies[other].parentJoint))
                links = other < self.links
                if joints[0] == joints[1] or (links and joints[1] - joints[0] == 1):
                    continue
                if links:
                    places = (data.oMg[at] for at in (one, other))
                    transforms = [coal.Transform3s(place.rotation, place.translation) for place in places]
                    answer = coal.DistanceResult()
                    gap = coal.distance(
                        bodies[one].geometry, transforms[0], bodies[other].geometry, transforms[1],
                        coal.DistanceRequest(), answer,
                    )  # fmt: skip
                    if gap <= 2e-5:
                        home.add(frozenset((self.names[one], self.names[other])))
                pairs.append((one, other))
        return [pair for pair in pairs if frozenset(self.names[at] for at in pair) not in home]

    def distances(self, q):
        """Return the distances (P, K) of all pairs at joint positions [m]."""
        found = np.empty((len(q), len(self.pairs)))
        for row, values in enumerate(q):
            pin.computeDistances(self.model, self.state, self.geometry, self.data, values)
            found[row] = [one.min_distance for one in self.data.distanceResults]
        return found


def tool_of(random):
    """Return a tool of two shapes on the flange."""
    from tests.collision.test_proof import mount, some_shape

    parts = [
        ToolShape(
            mount(random.uniform(-0.1, 0.1, 3), random.uniform(-3, 3, 3)).transform, some_shape(random, 0.1)
        )
        for _ in range(2)
    ]
    return Tool("TOOL", True, 0.0, np.zeros(3), np.zeros((3, 3)), tuple(parts))
