"""A robot, read from its files: limits by tomllib, the kinematic chain by Pinocchio."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

Pose = tuple[Array, Any]
"""Position (3,) [mm], and rotation (scipy's Rotation)."""


class Arm:
    """A robot, read from its files without the compiler's code.

    Args:
        description: text of robot.toml.
        urdf: text of the URDF.
    """

    def __init__(self, description: str, urdf: str) -> None:
        self.data: dict[str, Any] = tomllib.loads(description)
        self.model = pinocchio.buildModelFromXML(urdf)
        self.workspace = self.model.createData()
        ids = [self.model.getJointId(name) for name in self.data["joints"]]
        self.places = [self.model.joints[number].idx_q for number in ids]
        self.slides = np.array(["P" in self.model.joints[number].shortname()[7:] for number in ids])
        self.si = np.where(self.slides, 1e-3, np.pi / 180.0)
        self.base = self.model.getFrameId(self.data["base"])
        self.flange = self.model.getFrameId(self.data["flange"])
        joints = self.data["joints"].values()
        self.lower, self.upper = np.array([joint["position"] for joint in joints]).T
        ramps = self.data.get("ramps", {})  # times in ms, for joints without a value of their own
        self.velocity = np.array([joint["velocity"] for joint in joints])
        self.acceleration = np.array(
            [joint.get("acceleration") or joint["velocity"] * 1e3 / ramps["rise"] for joint in joints]
        )
        self.jerk = np.array(
            [
                joint.get("jerk") or rate * 1e3 / ramps["ease"]
                for joint, rate in zip(joints, self.acceleration, strict=True)
            ]
        )
        self.counts = np.diag(self.data["actuation"]["K"]) @ np.array(self.data["actuation"]["J"])
        self.motor_velocity = np.array(self.data["motors"]["velocity"]) * 1e3
        frame = self.data["frames"]["TCP"]
        rotation = Rotation.from_euler("xyz", frame.get("rpy", [0, 0, 0]), degrees=True).as_matrix()
        self.tcp = pinocchio.SE3(rotation, np.array(frame.get("xyz", [0, 0, 0])) * 1e-3)
        self._last: tuple[Any, Any] = None, None
        self._straight = self._pose(np.zeros(len(ids)))
        self._screws = self._screws_of(ids)
        for q in np.random.default_rng(0).uniform(-2.0, 2.0, (3, len(ids))):
            places, turns = self._by_screws(q[None])
            np.testing.assert_allclose(places[0], self._pose(q).translation, atol=1e-12)
            np.testing.assert_allclose(turns[0], self._pose(q).rotation, atol=1e-12)

    @classmethod
    def in_folder(cls, folder: Path) -> Arm:
        """Return the robot whose files are in a folder."""
        description = (folder / "robot.toml").read_text(encoding="utf-8")
        return cls(description, (folder / tomllib.loads(description)["urdf"]).read_text(encoding="utf-8"))

    def poses(self, q_deg: Array) -> tuple[Array, Any]:
        """Return the positions [mm] and the rotations of {TCP} in {B} for joint positions (N, n) [deg, mm].

        The last result is cached, because the same positions are often requested twice in a row.
        """
        q_deg = np.asarray(q_deg)
        key = q_deg.shape, q_deg.tobytes()
        if self._last[0] != key:
            places, turns = self._by_screws(q_deg * self.si)
            self._last = key, (places * 1e3, Rotation.from_matrix(turns))
        found: tuple[Array, Any] = self._last[1]
        return found

    def _pose(self, q: Array) -> Any:
        """Return the pose of {TCP} in {B} [m] at joint positions [rad or m], computed by Pinocchio."""
        whole = pinocchio.neutral(self.model)
        whole[self.places] = q
        pinocchio.forwardKinematics(self.model, self.workspace, whole)
        base = pinocchio.updateFramePlacement(self.model, self.workspace, self.base)
        flange = pinocchio.updateFramePlacement(self.model, self.workspace, self.flange)
        return base.actInv(flange) * self.tcp

    def _screws_of(self, ids: list[int]) -> list[Any]:
        """Return the screw axes of the joints in {B}, computed by Pinocchio: their directions and moments.
        Sliding joints have no angular part.
        """
        whole = pinocchio.neutral(self.model)
        whole[self.places] = 0.0
        jacobians = pinocchio.computeJointJacobians(self.model, self.workspace, whole)
        base = pinocchio.updateFramePlacement(self.model, self.workspace, self.base)
        columns = [jacobians[:, self.model.joints[number].idx_v] for number in ids]
        return [base.actInv(pinocchio.Motion(column)) for column in columns]

    def _by_screws(self, q: Array) -> tuple[Array, Array]:
        """Return the positions [m] and the rotation matrices of {TCP} in {B} for many joint positions (N, n)
        [rad or m] at once, by the product of exponentials. The results are those of `_pose`.
        """
        count = len(q)
        places, turns = (
            np.tile(self._straight.translation, (count, 1)),
            np.tile(self._straight.rotation, (count, 1, 1)),
        )
        # From the last joint to the first: each joint moves everything after it. The axis of a rotation
        # passes through the point axis x moment.
        for screw, slides, value in reversed(list(zip(self._screws, self.slides, q.T, strict=True))):
            if slides:
                places = places + value[:, None] * screw.linear
                continue
            axis, moment = screw.angular, screw.linear
            point = np.cross(axis, moment)
            turn = Rotation.from_rotvec(value[:, None] * axis).as_matrix()
            places = np.einsum("nij,nj->ni", turn, places - point) + point
            turns = turn @ turns
        return places, turns
