"""Points of bodies, placed by Pinocchio, and zones by their plain definitions. Neither shares code with
yarclang's proofs.
"""

import coal
import numpy as np
import pinocchio as pin

from tests.collision.dense import Dense
from yarclang.cell.model import HalfSpace, ShapeRegion, Zone
from yarclang.shapes import Box, Capsule, Cylinder, Sphere
from yarclang.transforms import rpy_rotation


def inside(region, points):
    """Return which of the points (..., 3) are in a region, by its definition."""
    if isinstance(region, HalfSpace):
        return points @ region.normal >= region.offset
    x, y, z = np.moveaxis((points - region.base_from_shape[:3, 3]) @ region.base_from_shape[:3, :3], -1, 0)
    match region.shape:
        case Box(size=size):
            return (np.abs(x) <= size[0] / 2) & (np.abs(y) <= size[1] / 2) & (np.abs(z) <= size[2] / 2)
        case Sphere(radius=radius):
            return x**2 + y**2 + z**2 <= radius**2
        case Cylinder(radius=radius, length=length):
            return (x**2 + y**2 <= radius**2) & (np.abs(z) <= length / 2)
        case Capsule(radius=radius, length=length):
            return x**2 + y**2 + np.maximum(np.abs(z) - length / 2, 0) ** 2 <= radius**2


def cloud(shape, random, count=400):
    """Return points (V, 3) of a body in its own axes, most of them on its surface."""
    unit = random.normal(size=(count, 3))
    unit /= np.linalg.norm(unit, axis=1)[:, None]
    match shape:
        case coal.Box():
            cube = random.uniform(-1, 1, (count, 3))
            cube /= np.abs(cube).max(axis=1)[:, None]
            corners = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
            return np.concatenate([cube, corners]) * np.array(shape.halfSide)
        case coal.Sphere():
            return unit * shape.radius
        case coal.Capsule():
            ends = random.choice([-1.0, 1.0], count) * np.minimum(random.uniform(0, 2, count), 1)
            return unit * shape.radius + np.outer(ends, [0, 0, shape.halfLength])
        case coal.Cylinder():
            flat = unit * [1, 1, 0]
            flat /= np.linalg.norm(flat, axis=1)[:, None]
            ends = random.choice([-1.0, 1.0], count) * np.minimum(random.uniform(0, 2, count), 1)
            return flat * shape.radius + np.outer(ends, [0, 0, shape.halfLength])
        case _:
            return np.array(shape.points())


class Clouds:
    """The bodies that zones watch, as points: bodies of a robot and of what it carries, the elbow, and a
    frame on the flange.
    """

    def __init__(self, robot, cell, flange_from_moving, random):
        self.dense = Dense(robot, cell)
        self.robot, self.moving = robot, flange_from_moving
        model, objects = self.dense.model, self.dense.geometry.geometryObjects
        self.carried = {one.name for one in cell.obstacles if one.mount.on_flange}
        self.parts = []
        for at, one in enumerate(objects):
            is_link = at < self.dense.links
            name = one.name.rsplit("_", 1)[0] if is_link else one.name
            if is_link or name in self.carried:
                moves = one.parentJoint > 0
                self.parts.append((name, is_link and moves, at, cloud(one.geometry, random)))
        joint, flange, _ = self.dense._ends(robot)
        self.flange = joint, flange
        # The elbow of the library's robots is at their third joint.
        self.elbow = model.getJointId("J3")

    def watched(self, part, q):
        """Return points (P, V, 3) in {B} of the bodies that a zone watches, by name, at joint positions."""
        dense, found = self.dense, {}
        base = np.linalg.inv(dense._ends(self.robot)[2])
        for row, values in enumerate(q):
            pin.forwardKinematics(dense.model, dense.state, values)
            pin.updateGeometryPlacements(dense.model, dense.state, dense.geometry, dense.data)
            seen = {}
            if part in ("tool", "tcp"):
                joint, flange = self.flange
                seen["point"] = (dense.state.oMi[joint].homogeneous @ flange @ self.moving)[None, :3, 3]
            for name, moves, at, points in self.parts:
                wanted = (
                    part == name or (part == "arm" and moves) or (part == "tool" and name in self.carried)
                )
                if wanted:
                    placed = dense.data.oMg[at]
                    seen[f"{name} {at}"] = points @ placed.rotation.T + placed.translation
            if part == "elbow":
                seen["the elbow"] = dense.state.oMi[self.elbow].translation[None]
            for name, points in seen.items():
                here = points @ base[:3, :3].T + base[:3, 3]
                found.setdefault(name, np.empty((len(q), *here.shape)))[row] = here
        return found


def drawn_region(random, *, large=False):
    """Return a random region of any shape around the robot."""
    a, b, c = random.uniform(0.1, 1.0, 3) * (2.0 if large else 1.0) + (1.0 if large else 0.0)
    placed = np.eye(4)
    placed[:3, :3] = rpy_rotation(random.uniform(-3, 3, 3))
    placed[:3, 3] = [0, 0.4, 1.2] if large else random.uniform([-1.2, -1.2, 0], [1.2, 1.2, 2.2])
    match random.integers(5):
        case 0:
            return HalfSpace(placed[:3, 2].copy(), -1.2 if large else float(random.uniform(0.8, 1.6)))
        case 1:
            return ShapeRegion(placed, Box(np.array([a, b, c])))
        case 2:
            return ShapeRegion(placed, Sphere(a))
        case 3:
            return ShapeRegion(placed, Cylinder(a, b))
        case _:
            return ShapeRegion(placed, Capsule(a, b))


WATCHED = (("tool",), ("tcp",), ("elbow",), ("arm",), ("link_4",), ("tool", "link_2"))


def drawn_zone(random, name, rule, **more):
    region = drawn_region(random, large=rule == "allowed")
    margin = float(random.choice([0.0, 0.0, 0.05]))
    return Zone(name, rule, region, watch=WATCHED[random.integers(len(WATCHED))], margin=margin, **more)
