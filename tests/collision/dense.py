"""Distances by fine samples, computed without yarclang: Pinocchio reads the URDF and SRDF, and coal computes
the distances.
"""

import coal
import numpy as np
import pinocchio as pin

from yarclang.shapes import Box, Capsule, Cylinder, Sphere


def shape_of(shape):
    """Return a shape as one of coal's."""
    match shape:
        case Box(size=size):
            return coal.Box(*size)
        case Sphere(radius=radius):
            return coal.Sphere(radius)
        case Cylinder(radius=radius, length=length):
            return coal.Cylinder(radius, length)
        case Capsule(radius=radius, length=length):
            return coal.Capsule(radius, length)


class Dense:
    """A robot from the library or a folder, with the obstacles of a cell (no meshes)."""

    def __init__(self, robot, cell=None):
        path = str(robot.folder / robot.urdf)
        self.model = pin.buildModelFromUrdf(path)
        self.geometry = pin.buildGeomFromUrdf(
            self.model, path, pin.GeometryType.COLLISION, package_dirs=[str(robot.folder)]
        )
        self.links = self.geometry.ngeoms
        joint, flange, base = self._ends(robot)
        for one in cell.obstacles if cell else ():
            placed = one.mount.transform
            carried = one.mount.on_flange
            pose = pin.SE3(flange @ placed if carried else base @ placed)
            shape = pin.GeometryObject(one.name, joint if carried else 0, pose, shape_of(one.shape))
            self.geometry.addGeometryObject(shape)
        self.margin = np.array([0.0] * self.links + [one.margin for one in (cell.obstacles if cell else ())])
        objects = self.geometry.geometryObjects
        self.pairs = []
        for one in range(len(objects)):
            for other in range(one):
                joints = sorted((objects[one].parentJoint, objects[other].parentJoint))
                both_links = one < self.links and other < self.links
                if joints[0] == joints[1] or (both_links and joints[1] - joints[0] == 1):
                    continue
                self.pairs.append((other, one))
                self.geometry.addCollisionPair(pin.CollisionPair(other, one))
        self.data, self.state = self.geometry.createData(), self.model.createData()

    def _ends(self, robot):
        """Return the flange's joint and its pose on the joint, and the pose of {B}, which no joint moves."""
        import tomllib

        named = tomllib.loads((robot.folder / "robot.toml").read_text())
        frames = [
            self.model.frames[self.model.getFrameId(named[end], pin.FrameType.BODY)]
            for end in ("flange", "base")
        ]
        return frames[0].parentJoint, frames[0].placement.homogeneous, frames[1].placement.homogeneous

    def distances(self, q):
        """Return the distances (P, K) of all pairs at joint positions [m]."""
        found = np.empty((len(q), len(self.pairs)))
        for row, values in enumerate(q):
            pin.computeDistances(self.model, self.state, self.geometry, self.data, values)
            found[row] = [one.min_distance for one in self.data.distanceResults]
        return found

    def names(self, pair):
        """Return the names of a pair's links or obstacles. (Pinocchio adds a number to the name of
        a link.)
        """
        objects = self.geometry.geometryObjects
        return {
            objects[at].name.rsplit("_", 1)[0] if at < self.links else objects[at].name
            for at in self.pairs[pair]
        }

    def wanted(self, pair):
        """Return the margin of a pair."""
        return max(self.margin[at] for at in self.pairs[pair])
