"""A reading of the emitted text that shares nothing with yarclang: regular expressions, scipy's B-splines, Pinocchio.

It samples the executed motion densely and says how far it is from what the program says, and how much of
each limit it uses. Limits come from robot.toml by tomllib, the arm from the URDF by Pinocchio.
"""

import re
import tomllib
from dataclasses import dataclass

import numpy as np
import pinocchio
from scipy.interpolate import BSpline, CubicSpline
from scipy.spatial.transform import Rotation, Slerp


class Arm:
    """The robot as its files say."""

    def __init__(self, folder):
        self.data = tomllib.loads((folder / "robot.toml").read_text())
        self.model = pinocchio.buildModelFromUrdf(str(folder / self.data["urdf"]))
        self.workspace = self.model.createData()
        ids = [self.model.getJointId(name) for name in self.data["joints"]]
        self.places = [self.model.joints[number].idx_q for number in ids]
        self.slides = np.array(["P" in self.model.joints[number].shortname()[7:] for number in ids])
        self.si = np.where(self.slides, 1e-3, np.pi / 180.0)
        self.base = self.model.getFrameId(self.data["base"])
        self.flange = self.model.getFrameId(self.data["flange"])
        joints = self.data["joints"].values()
        self.lower, self.upper = np.array([joint["position"] for joint in joints]).T
        ramps = self.data.get("ramps", {})  # times in ms, for joints that don't say it themselves
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
        self._last = None, None
        self._straight = self._pose(np.zeros(len(ids)))
        self._screws = self._screws_of(ids)
        for q in np.random.default_rng(0).uniform(-2.0, 2.0, (3, len(ids))):
            places, turns = self._by_screws(q[None])
            np.testing.assert_allclose(places[0], self._pose(q).translation, atol=1e-12)
            np.testing.assert_allclose(turns[0], self._pose(q).rotation, atol=1e-12)

    def poses(self, q_deg):
        """Positions [mm] and rotations of {TCP} in {B} for joint positions in deg (mm). What is asked again at once isn't computed again."""
        q_deg = np.asarray(q_deg)
        key = q_deg.shape, q_deg.tobytes()
        if self._last[0] != key:
            places, turns = self._by_screws(q_deg * self.si)
            self._last = key, (places * 1e3, Rotation.from_matrix(turns))
        return self._last[1]

    def _pose(self, q):
        """The pose by Pinocchio [m], of joint positions [rad or m]."""
        whole = pinocchio.neutral(self.model)
        whole[self.places] = q
        pinocchio.forwardKinematics(self.model, self.workspace, whole)
        base = pinocchio.updateFramePlacement(self.model, self.workspace, self.base)
        flange = pinocchio.updateFramePlacement(self.model, self.workspace, self.flange)
        return base.actInv(flange) * self.tcp

    def _screws_of(self, ids):
        """Axes and moments of the joints in {B} by Pinocchio, those of the slides without a turn."""
        whole = pinocchio.neutral(self.model)
        whole[self.places] = 0.0
        jacobians = pinocchio.computeJointJacobians(self.model, self.workspace, whole)
        base = pinocchio.updateFramePlacement(self.model, self.workspace, self.base)
        columns = [jacobians[:, self.model.joints[number].idx_v] for number in ids]
        return [base.actInv(pinocchio.Motion(column)) for column in columns]

    def _by_screws(self, q):
        """The same as `_pose` of many joint positions (N, n) at once: a product of exponentials."""
        count = len(q)
        places, turns = (
            np.tile(self._straight.translation, (count, 1)),
            np.tile(self._straight.rotation, (count, 1, 1)),
        )
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


@dataclass
class Executed:
    """One command as executed: control points [deg], segment time [s], samples."""

    control: np.ndarray
    segment: float

    def __post_init__(self):
        n = len(self.control) - 3
        self.duration = n * self.segment
        self.spline = BSpline(np.arange(-3, n + 4) * self.segment, self.control, 3)

    def sample(self, order=0, per_segment=8):
        n = len(self.control) - 3
        times = np.linspace(0.0, self.duration, n * per_segment + 1)
        return self.spline(times, nu=order)


def read(text):
    """The start [deg] and the commands of a text, by step number, as the controller would execute them."""
    lines = text.split("\n")
    table = {}
    for line in lines:
        if found := re.match(
            r"; command (\d+) (\S+) (\S+) \d+ (\d+) (\d+)(?: blend \d+)?(?: any-jerk)?$", line
        ):
            table[int(found[1])] = (int(found[4]), int(found[5]))
    start = _axes(lines[lines.index("RAPID") + 2])
    tm, sequences = None, []
    for number, line in enumerate(lines, 1):
        if line.startswith("TM"):
            tm = float(line[2:])
            sequences.append((tm, [], []))
        elif line and line[0] in "XYZUVWABC" and tm is not None and line != "CLOSE":
            sequences[-1][1].append(number)
            sequences[-1][2].append(_axes(line))
    commands, stands = {}, start
    for tm, numbers, points in sequences:
        f = np.array([stands] * 3 + points + [points[-1]] * 2)
        position = {number: k + 3 for k, number in enumerate(numbers)}
        at = 0  # the knot at which the command begins
        for step, (first, last) in table.items():
            if first not in position:
                continue
            end = len(f) - 3 if position[last] == len(f) - 3 else position[last] - 2
            commands[step] = Executed(f[at : end + 3], tm * 1e-3)
            at = end
        assert at == len(f) - 3
        stands = points[-1]
    return start, commands


def _axes(line):
    return np.array([float(value) for value in re.findall(r"[A-Z](-?[0-9.]+)", line)])


def shares(arm, executed):
    """The largest share of each limit that an executed command uses."""
    q, v, a, j = (executed.sample(order) for order in range(4))
    span = (arm.upper - arm.lower) / 2
    return {
        "position": np.abs((q - (arm.upper + arm.lower) / 2) / span).max(),
        "velocity": np.abs(v / arm.velocity).max(),
        "acceleration": np.abs(a / arm.acceleration).max(),
        "jerk": np.abs(j / arm.jerk).max(),
        "motor": np.abs(v @ arm.counts.T / arm.motor_velocity).max(),
    }


def off_line(arm, executed, goal_point, goal_rotation):
    """Largest distance [mm] and angle [deg] of an executed command from the straight line to a goal."""
    points, rotations = arm.poses(executed.sample(per_segment=4))
    start_point, start_rotation = points[0], rotations[0]
    shift = goal_point - start_point
    turn = start_rotation.inv() * goal_rotation
    # how far along the way each sample is: position and angle together, each in units of its tolerance
    weight_p, weight_a = 1 / 0.02**2, 1 / np.radians(0.002) ** 2
    turned = (start_rotation.inv() * rotations).as_rotvec() @ turn.as_rotvec()
    whole = weight_p * shift @ shift + weight_a * turn.magnitude() ** 2
    s = np.clip((weight_p * (points - start_point) @ shift + weight_a * turned) / max(whole, 1e-30), 0.0, 1.0)
    wanted = Slerp([0, 1], Rotation.concatenate([start_rotation, goal_rotation]))(s)
    distance = np.linalg.norm(points - (start_point + s[:, None] * shift), axis=1).max()
    return distance, np.degrees((wanted.inv() * rotations).magnitude().max())


def off_joint_line(executed, goal):
    """Largest distance [deg] of any joint from the straight line in joint space to a goal."""
    q = executed.sample()
    start = q[0]
    way = goal - start
    s = np.clip((q - start) @ way / max(way @ way, 1e-30), 0.0, 1.0)
    return np.abs(q - (start + s[:, None] * way)).max()


def off_spline(executed, waypoints):
    """Largest distance [deg] of any joint from the natural spline through start and way-points."""
    q = executed.sample()
    through = [q[0]]
    for waypoint in waypoints:
        if np.linalg.norm(waypoint - through[-1]) > 1e-9:
            through.append(np.asarray(waypoint))
    if len(through) == 1:
        return np.abs(q - q[0]).max()
    through = np.array(through)
    knots = np.concatenate(([0], np.cumsum(np.linalg.norm(np.diff(through, axis=0), axis=1))))
    curve = CubicSpline(knots, through, bc_type="natural")
    s = np.linspace(0, knots[-1], 20 * len(q))
    path = curve(s)
    # to the polyline of a fine sampling: its own error is far below the tolerance
    worst, at = 0.0, 0
    for point in q:
        window = path[at : at + 2000]
        k = at + int(np.argmin(np.linalg.norm(window - point, axis=1)))
        at = max(0, k - 200)
        near = path[max(0, k - 1) : k + 2]
        worst = max(worst, min(_to_segment(point, near[i], near[i + 1]) for i in range(len(near) - 1)))
    return worst


def _to_segment(point, a, b):
    way = b - a
    t = np.clip((point - a) @ way / max(way @ way, 1e-30), 0.0, 1.0)
    return np.abs(point - a - t * way).max()


def overlaps(text):
    """The segments in which each command overlaps with the next, by step number, of those that do."""
    found = re.finditer(r"^; command (\d+) .* blend (\d+)(?: any-jerk)?$", text, re.MULTILINE)
    return {int(one[1]): int(one[2]) for one in found}
