"""Verification of a live motion's text with the certificate's arithmetic. This module doesn't know how the
text was created.

It reads the printed numbers. Together with the lines that were admitted before, the text must respect at
every instant the limits of position, velocity, acceleration and jerk of each joint, the speed limits of the
motors, the largest speed of the tool, the distances of all bodies, and the zones. The text must end at rest.

The motion begins at the commanded position of the motors: the first three control points of SPLINE1 are this
position, and no line contains it. Therefore this position is an argument here, with the precision of the
controller's registers, and the robot need not move to a printed start first. The streaming code reads the
position again right before the motion, and doesn't begin if it is farther away than `slack`. If each of the
three points is off by d, then the velocities in the first three segments are off by at most d / h, the
accelerations by d / h^2, and the jerks by 2 d / h^3 (the differences of d, d, d, 0, 0, 0). All checks allow
for these additional amounts.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from yarclang.cell.model import Cell
from yarclang.certify.motion.bounds import Cubics, reaches
from yarclang.certify.motion.limits import POSITION_UNITS, RELATIVE
from yarclang.certify.motion.speed import KEPT
from yarclang.collision.course import Course
from yarclang.collision.proof import SLACK, clearances
from yarclang.collision.scene import Scene, scene_of
from yarclang.collision.zones.proof import kept
from yarclang.collision.zones.speed import fastest_inside
from yarclang.collision.zones.watched import Moving
from yarclang.collision.zones.workspace import Watch, watches_of
from yarclang.coordinator.live.room import Room, is_free
from yarclang.diagnostics import Result
from yarclang.robot.actuation import counts_per_joint
from yarclang.robot.kinematics.fk import poses_and_jacobians
from yarclang.robot.model import START_SHARE, Array, Robot
from yarclang.units import MM

_BEYOND = 1.0
"""Assumed largest distance of the tool's collision bodies from the tool's origin [m]. From this distance
follows how far a deviation at the start can shift these bodies from the proved motion.
"""

_AHEAD, _AROUND = 1.5, 1e-3
"""Size of the room (a box of joint positions around the end of a text) that is tested for collisions. The box
reaches `_AHEAD` times as far as the text itself, plus `_AROUND` [rad or m].
"""

_CROWDED = 8
"""If a test finds no free room, this number of texts is proved before room is tested again, because each test
takes time.
"""

_PIECES = (1, 8, 64)
"""Numbers of pieces into which a segment's time is cut to bound the tool's speed. If the bound with one
number is too high, the next number is tried.
"""


class Judge:
    """Proves the text of a live motion: each group of new lines before it is streamed.

    Args:
        robot: the robot with its limits.
        start: (n,) commanded position before the motion [rad or m].
        segment: segment time [s].
        speed: largest speed of the tool's origin [m/s].
        tool: (4, 4) flange_from_tool.
        scene: bodies that must stay apart; None if there are none.
        watches: zones of the cell.
        strict: bodies that must stay apart as soon as the robot has left the part that it touches at the
            start; None: it touches none.
        points: reads the control points (k, n) [rad or m] of a text's lines, or returns the reason why it
            can't.

    Attributes:
        slack: (n,) allowed deviation of each joint from `start` when the motion begins [rad or m]: a fraction
            of a count. It moves no point of the arm by more than half of the collision proof's `SLACK`, so
            bodies stay apart and zones are respected to that precision.
        stopped_by: bodies and zones named in the last objection; empty: none.
    """

    def __init__(
        self,
        robot: Robot,
        start: Array,
        segment: float,
        speed: float,
        tool: Array,
        scene: Scene | None = None,
        watches: tuple[Watch, ...] = (),
        *,
        strict: Scene | None = None,
        points: Callable[[Robot, tuple[str, ...]], Array | str],
    ) -> None:
        self._points = points
        self._robot = robot
        self._segment = segment
        self._speed = speed
        self._tool = tool
        self._scene = scene
        self._strict = strict
        self._slow = [one for one in watches if one.zone.rule == "slow"]
        self._watches = tuple(one for one in watches if one.zone.rule != "slow")
        self._motors = counts_per_joint(robot)
        travel = np.maximum(np.abs(robot.limits.lower), np.abs(robot.limits.upper))
        self._reach = reaches(robot.chain, tool, np.where(robot.chain.is_prismatic, travel, 0.0))
        limits = robot.limits
        arms = np.where(robot.chain.is_prismatic, 1.0, self._reach + _BEYOND)
        self.slack = np.minimum(
            START_SHARE * np.minimum(limits.acceleration * segment**2, limits.jerk * segment**3 / 2.0),
            SLACK / 2.0 / (robot.size * arms),
        )
        self._beside = float(arms @ self.slack)
        self._behind = np.tile(start, (3, 1))
        self._starts = 3
        self._room: Room | None = None
        self._crowded = 0
        self.stopped_by: tuple[str, ...] = ()

    def objection(self, lines: tuple[str, ...], tail: tuple[str, ...]) -> str:
        """Return the reason why lines must not be streamed. Empty: the lines are proved, together with the
        motion to rest after them.

        Args:
            lines: lines to be streamed.
            tail: lines after them that would bring the robot to rest.
        """
        self.stopped_by = ()
        points = self._points(self._robot, (*lines, *tail))
        if isinstance(points, str):
            return points
        last = points[-3:] if len(points) >= 3 else np.concatenate([self._behind, points])[-3:]
        if np.ptp(last, axis=0).any():
            return "the path after the increment doesn't end at rest"
        control = np.concatenate([self._behind, points])
        count = len(control) - 3
        cubics = Cubics.of_spline(control, np.arange(count), np.full(count, self._segment))
        # Each segment depends on four control points. The first segments depend on points of the start
        # position, which may be off.
        off = np.where(np.arange(count) < self._starts, 1.0, 0.0)
        beside = off * self._beside
        # The velocity of a point is J(q) w, with its Jacobian J, the joint positions q and the joint
        # velocities w. In the first segments, the error of w adds at most beside / h to it (h: the segment
        # time), and the error of q in J(q) adds at most beside times the sum of |w|.
        faster = beside * (1.0 / self._segment + cubics.velocity_peaks().sum(axis=1))
        return (
            self._limits(cubics, off[:, None] * self.slack)
            or self._tool_speed(cubics, faster)
            or self._surroundings(cubics, control, float(faster.max()))
        )

    def admit(self, lines: tuple[str, ...]) -> None:
        """Record that lines are streamed. `objection` must have returned no reason against them."""
        points = self._points(self._robot, lines)
        assert not isinstance(points, str)
        self._behind = np.concatenate([self._behind, points])[-3:]
        if self._strict is not None and len(points):
            # The motion continues from these three points. As soon as all bodies are apart around them, the
            # bodies that were allowed to touch at the start must stay apart.
            lower, upper = self._behind.min(axis=0), self._behind.max(axis=0)
            around = Room((lower + upper) / 2.0, upper - lower + _AROUND)
            if is_free(self._strict, around):
                self._scene, self._strict, self._room, self._crowded = self._strict, None, None, 0
        self._starts = max(0, self._starts - len(points))

    def _limits(self, cubics: Cubics, off: Array) -> str:
        """Return the reason why the motion exceeds a limit of a joint or motor; empty if it exceeds none. The
        control points of each segment may be off by `off` (N, n) [rad or m].
        """
        h = self._segment
        robot, limits, names = self._robot, self._robot.limits, self._robot.joint_names
        lower, upper = cubics.position_range()
        # A control point that may be off by `off` may also be beyond a limit by that much.
        past = (np.maximum(upper - limits.upper, limits.lower - lower) - off).max(axis=0) / robot.axis_units
        if (past > POSITION_UNITS).any():
            return f"{names[int(np.argmax(past))]} would go past its limit"
        # If control points are off by `off`, velocities are off by at most off / h, accelerations by off /
        # h^2, and jerks by 2 off / h^3 (module docstring).
        shares = {
            "velocity": (cubics.velocity_peaks() + off / h) / limits.velocity,
            "acceleration": (cubics.acceleration_peaks() + off / h**2) / limits.acceleration,
            "jerk": (np.abs(cubics.j) + 2.0 * off / h**3) / limits.jerk,
        }
        for what, share in shares.items():
            worst = share.max(axis=0)
            if (worst > 1.0 + RELATIVE).any():
                joint = int(np.argmax(worst))
                return f"{names[joint]} would have {worst[joint]:.1%} of its {what} limit"
        speeds = cubics.mapped(self._motors).velocity_peaks() + off / h @ np.abs(self._motors).T
        motors = (speeds / robot.actuation.velocity).max(axis=0)
        if (motors > 1.0 + RELATIVE).any():
            motor = int(np.argmax(motors))
            return f"motor {robot.controller.motors[motor]} would have {motors[motor]:.1%} of its speed limit"
        return ""

    def _tool_speed(self, cubics: Cubics, faster: Array) -> str:
        """Return the reason why the tool may be too fast; empty if it can't be.

        A segment's time is cut into shorter pieces until the bound is tight enough. In each segment the tool
        may be faster than computed by `faster` (N,) [m/s].
        """
        worst = 0.0
        for pieces in _PIECES:
            speed = self._speed_bounds(cubics, pieces) + faster
            worst = float(speed.max())
            (open_,) = np.nonzero(speed > self._speed * (1.0 + RELATIVE))
            if not len(open_):
                return ""
            cubics, faster = cubics.take(open_), faster[open_]
        return f"the tool might reach {worst / MM:.1f} mm/s, of {self._speed / MM:g} at most"

    def _speed_bounds(self, cubics: Cubics, pieces: int) -> Array:
        """Return an upper bound of the speed of the tool's origin in each segment, as (N,) [m/s].

        Each segment's time is cut into `pieces` equal intervals. The bound is the speed at the middle of an
        interval, plus the largest increase from the middle to the ends of the interval. This increase follows
        from a bound on the acceleration: |p''| is at most the sum over joints m of R_m (B_m - B_(m-1)). R_m
        is the reach of joint m, and B_m = (sum w)^2 + sum a, with the largest velocities w and accelerations
        a of the joints up to m, as in `bounds.arm_fourth`. A sliding joint enters once, with length 1.
        """
        robot, half = self._robot, self._segment / (2.0 * pieces)
        count = len(cubics.h)
        row = np.repeat(np.arange(count), pieces)
        times = np.tile((2.0 * np.arange(pieces) + 1.0) * half, count)
        q, rate = cubics.take(row).at(times)
        jacobians = poses_and_jacobians(robot.chain, q, self._tool)[1]
        speed = np.linalg.norm(np.einsum("nij,nj->ni", jacobians[:, :3], rate), axis=1)
        w, a = cubics.velocity_peaks(), cubics.acceleration_peaks()
        sum_w = sum_a = before = bend = np.zeros(count)
        for m, prismatic in enumerate(robot.chain.is_prismatic):
            if prismatic:
                bend = bend + 2.0 * sum_w * w[:, m] + a[:, m]
                continue
            sum_w, sum_a = sum_w + w[:, m], sum_a + a[:, m]
            upto = sum_w**2 + sum_a
            bend = bend + self._reach[m] * (upto - before)
            before = upto
        # From the middle of a piece to its ends, |p'| grows by at most `half` times the largest |p''|.
        bounds: Array = speed.reshape(count, pieces).max(axis=1) + half * bend
        return bounds

    def _surroundings(self, cubics: Cubics, control: Array, faster: float) -> str:
        scene = self._scene
        if scene is None:
            return ""
        apart = not len(scene.pairs.first) or self._has_room(scene, control)
        if apart and not (self._watches or self._slow):
            return ""
        course = Course.of(cubics.x, cubics.v, cubics.a, cubics.j, cubics.h, cubics.velocity_peaks())
        spans = np.array([[0, len(cubics.h)]])
        if not apart:
            found = clearances(scene, course, spans)
            if found.meetings:
                one, other = self.stopped_by = scene.names(found.meetings[0].pair)
                return f"{one} would come too close to {other}"
        if self._watches:
            broken = kept(scene, course, spans, self._watches).breaches
            if broken:
                zone = self._watches[broken[0].watch].zone.name
                self.stopped_by = (zone,)
                return f"the zone {zone} would be violated"
        for watch in self._slow:
            allowed = watch.zone.speed or 0.0
            fastest = float(fastest_inside(scene, course, spans, watch, least=allowed).speed[0])
            if fastest + faster > allowed * (1.0 + KEPT):
                self.stopped_by = (watch.zone.name,)
                return f"in the zone {watch.zone.name} it would be faster than {allowed / MM:g} mm/s"
        return ""

    def _has_room(self, scene: Scene, control: Array) -> bool:
        """Return True if all bodies stay apart in a whole box of joint positions that contains the text's
        control points. Then the path itself need not be checked: by the convex hull property, it stays within
        this box.
        """
        lower, upper, end = control.min(axis=0), control.max(axis=0), control[-1]
        if self._room is not None and self._room.has(lower, upper):
            return True
        if self._crowded:
            self._crowded -= 1
            return False
        # Center the room at the end of the text, so that it probably contains the next texts as well.
        room = Room(end, _AHEAD * np.maximum(upper - end, end - lower) + _AROUND)
        self._room = room if is_free(scene, room) else None
        self._crowded = _CROWDED if self._room is None else 0
        return self._room is not None


def surroundings_of(
    robot: Robot, cell: Cell | None, moving: Moving
) -> Result[tuple[Scene | None, tuple[Watch, ...]]]:
    """Return the bodies and zones that a robot in a cell must respect while the frame `moving` is moved.

    Returns:
        The bodies (None if there are none) and the zones. No value, but findings, if a body can't be read.
    """
    if not robot.shapes and not (cell and (cell.obstacles or cell.zones)):
        return Result((None, ()))
    made = scene_of(robot, cell)
    if made.value is None:
        return Result(None, made.diagnostics)
    watches = watches_of(robot, cell, moving) if cell and cell.zones else ()
    return Result((made.value, watches), made.diagnostics)
