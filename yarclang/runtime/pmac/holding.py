"""Holds of the motion of one job: stop it on its path, report the reason, and resume it. No I/O."""

from __future__ import annotations

import math

from yarclang.pmac.controller import turbo_pmac
from yarclang.runtime.actions import Left, Script, Trouble
from yarclang.runtime.job import Job
from yarclang.runtime.notices import Hold, Resume
from yarclang.runtime.operation import UNATTENDED
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.outputs import Outputs
from yarclang.runtime.pmac.rest import come_to_rest
from yarclang.runtime.pmac.rotary import Rotary
from yarclang.runtime.pmac.supervision import HELD, Flow
from yarclang.runtime.pmac.watching import raise_trouble
from yarclang.runtime.state import Event, State

_PAUSED = (
    "this computer or the link was too slow: measure it with `yarc doctor`, or allow more time with "
    "--patience"
)

_STILL = 0.5
"""Time after the planned end of a hold during which the robot may move nevertheless [s]."""


class Holding:
    """All holds of the motion during one job: they stop the motion on its path, and resume it.

    Attributes:
        refilling: True if the motion is held only until the rotary buffer is full again.
        way_out: name of the SUB by which the robot retreats when a person resumes; empty if the motion
            continues.
    """

    def __init__(self, operation: Operation, job: Job, rotary: Rotary) -> None:
        self.operation = operation
        self.refilling = False
        self.way_out = ""
        self._again = False
        self._job = job
        self._rotary = rotary
        self._supervision = rotary.supervision
        self._outputs = Outputs(job)
        self._secured_in_motion = False
        self._told: set[str] = set()

    def hold(self, reason: str, *, secure: bool = True) -> Script[None]:
        """Hold the motion on its path. Outputs get their safe values, unless `secure` is False."""
        robot = self._job.robot
        yield from self.operation.hold(turbo_pmac(robot).coordinate_system, robot.controller.hold_time)
        self.operation.go(Event.HOLD, reason)
        if secure:
            yield from self._secure()

    def _secure(self) -> Script[None]:
        """Set the outputs to their safe values while the robot slows down. If the program sets outputs, they
        get their safe values again when the robot rests (`_secure_at_rest`).
        """
        if self._job.outputs:
            yield from self._outputs.secure(self.operation)
            self._secured_in_motion = bool(self._job.sets)

    def _secure_at_rest(self) -> Script[None]:
        """Set the outputs to their safe values again: while the robot slowed down, it may have passed a line
        that sets one.
        """
        if self._secured_in_motion:
            self._secured_in_motion = False
            yield from self._outputs.secure(self.operation)

    def remember_outputs(self) -> Script[None]:
        """Ask for the values of the outputs before the job."""
        yield from self._outputs.remember(self.operation)

    def for_person(self) -> Script[None]:
        """Hold the motion until a person resumes. Orders that were given before the hold are dropped."""
        orders = self.operation.orders
        last = max(place for place, order in enumerate(orders) if order == Hold())
        remaining = [
            order
            for place, order in enumerate(orders)
            if not (isinstance(order, Hold) or (isinstance(order, Resume) and place < last))
        ]
        orders.clear()
        orders.extend(remaining)
        if self.operation.state is State.MOVE or self.refilling:
            self.refilling = False
            yield from self.hold("hold requested")

    def for_low_water(self) -> Script[None]:
        """Hold the motion because few lines are left in the buffer. The next step refills the buffer and
        resumes.

        If the guard PLC was faster and has held the motion, its hold is handled in the same way.
        """
        operation, feed = self.operation, self._rotary.feed
        ahead = feed.at_least(operation.now)
        yield from self.hold(f"buffer low: about {ahead} lines ahead, at least {feed.low} are needed")
        operation.remark("the buffer ran low: holding to refill it", warning=True)
        self.refilling = True

    def look_at(self, rests: bool) -> Script[None]:
        """Check, some time after a hold, that no other client moves the robot. If the robot moves, hold
        again; if it moves after that, too, abort.

        Args:
            rests: True if no motor has a desired velocity.

        Raises:
            Trouble: the robot still moved after the second hold, for example because of a jog, and was
                aborted.
        """
        operation = self.operation
        if rests:
            self._again = False
            if operation.now >= operation.settled:
                yield from self._secure_at_rest()
        if rests or self.refilling or operation.now < operation.settled + _STILL:
            return
        if self._again:
            yield from operation.abort()
            raise Trouble(
                "another client moves the robot during a hold, and a second hold doesn't stop it: all "
                "motors are stopped",
                "find the other client of this controller",
                "Y1605",
            )
        self._again = True
        controller = turbo_pmac(self._job.robot)
        yield from operation.hold(controller.coordinate_system, controller.hold_time)
        operation.remark(
            "another client uses this controller: the robot moves during a hold; it is held again",
            warning=True,
        )

    def for_others(self, changes: str) -> Script[None]:
        """Hold the motion because another client has changed a value that the proof depends on. The hold
        lasts until the change is undone and a person resumes.

        Raises:
            Trouble: the run is unattended, so nobody can resume it.
        """
        if changes in self._told:
            return
        slew = self._supervision.hold_again(changes)
        if slew:
            yield from self.operation.ask(slew)
            changes += f" (put back: {slew})"
        if self.operation.state is State.MOVE or slew:
            yield from self.hold(changes)
            also = yield from self._supervision.compare(all_=True)
            self._told |= {changes, also}
            changes = ", ".join(dict.fromkeys(one for one in (changes, also) if one))
        self._told.add(changes)
        self._check_attended(f"another client uses this controller: {changes}")
        self.operation.remark(
            f"another client uses this controller: {changes}; find the client, restore the value, then "
            "continue with Enter or `yarc resume`",
            warning=True,
        )

    def by_guard(self, flow: Flow) -> Script[None]:
        """Handle a hold by the controller's own guard: outputs get their safe values, and the next step
        refills the buffer and resumes. The guard itself sets no outputs.
        """
        operation, controller = self.operation, turbo_pmac(self._job.robot)
        # hold in any case: not the guard, but another client may have set the guard's flag
        yield from operation.hold(controller.coordinate_system, controller.hold_time)
        if flow.watched == HELD:
            silence = (
                f"the controller has received nothing from this computer for {operation.silence:.2g} s, "
                f"and holds"
            )
            operation.go(Event.HOLD, silence, remedy=_PAUSED)
            operation.remark(_PAUSED, warning=True)
        else:
            what = "the guard PLC has held the motion: too few lines were left in the buffer"
            operation.go(Event.HOLD, what, remedy=_PAUSED)
        yield from self._secure()
        yield from come_to_rest(operation, self._job.robot)
        yield from self._secure_at_rest()
        self.refilling = True

    def for_input(self, input_state: str, way_out: str = "", *, moves: bool = True) -> Script[None]:
        """Hold the motion because of a watched input, or don't begin the motion. The hold lasts until the
        input allows motion again and a person resumes.

        Args:
            input_state: the input and its state, in words.
            way_out: name of the SUB by which the robot retreats instead of continuing; empty if there is
                none.
            moves: True if the program has begun.

        Raises:
            Trouble: the run is unattended, so nobody can resume it.
        """
        if moves:
            yield from self.hold(f"{input_state}: held on the path")
        else:
            self.operation.go(Event.HOLD, f"{input_state}: the motion isn't started")
            if self._job.outputs:
                yield from self._outputs.secure(self.operation)
        if self.operation.unattended:
            raise Trouble(
                f"the program holds: {input_state}",
                "an unattended run can't be resumed: run the program again",
                "Y1637",
            )
        self.way_out = way_out
        resuming = f"retreat along the path and by {way_out}" if way_out else "continue"
        self.operation.remark(
            f"{input_state}; when that is over, {resuming} with Enter or `yarc resume`", warning=True
        )

    def after_sleep(self) -> Script[None]:
        """Don't begin the motion, because this process was suspended for a long time since the run has begun.
        The hold lasts until a person resumes.
        """
        operation = self.operation
        slept, operation.slept = operation.slept, 0.0
        operation.go(Event.HOLD, f"this process was suspended for {slept:.0f} s: the motion isn't started")
        if self._job.outputs:
            yield from self._outputs.secure(operation)
        operation.remark(UNATTENDED, warning=True)

    def by_nobody(self) -> Script[None]:
        """Handle a hold that this run didn't order: nothing moves although lines are in the buffer. Outputs
        get their safe values, and a person has to resume.

        Raises:
            Trouble: the run is unattended, so nobody can resume it.
        """
        operation = self.operation
        operation.go(Event.HOLD, "the motion is held, but not by this run")
        yield from self._secure()
        self._check_attended("another client holds the motion")
        operation.remark("another client holds the motion; resume it when this is safe", warning=True)

    def _check_attended(self, reason: str) -> None:
        """Check that a person can resume the motion.

        Raises:
            Trouble: the run is unattended, so nobody can resume it.
        """
        if self.operation.unattended:
            raise Trouble(reason, "an unattended run can't be resumed: run the program again", "Y1605")

    def go_on(self) -> Script[None]:
        """Resume the motion from rest: compare the settings, refill the buffer, restore guard and outputs,
        and send R.

        Raises:
            Left: an input has held the motion, and the robot retreats instead of continuing.
        """
        operation, feed, supervision = self.operation, self._rotary.feed, self._supervision
        # if an input holds the motion when a person resumes, the resume is refused, even if the input changes
        # a moment later
        if self._job.watches and self._stays_held((yield from self._rotary.ask())):
            return
        motors = yield from come_to_rest(operation, self._job.robot)
        raise_trouble(self._job.robot, motors)
        if changes_or_motion := (yield from supervision.compare(all_=True)):
            yield from self._stay_held(changes_or_motion)
            return
        if self.way_out:
            if not self._stays_held((yield from self._rotary.ask())):
                raise Left(self.way_out)
            return
        yield from self._rotary.ask()
        yield from self._rotary.check_full()
        while feed.packet():
            yield from self._rotary.write()
        flow = yield from self._rotary.ask()
        if changes_or_motion := supervision.stands_still(flow):
            yield from self._stay_held(changes_or_motion)
            return
        if self._stays_held(flow):
            return
        if flow.armed == HELD and not self.refilling:
            operation.remark("the guard PLC has held the motion as well", warning=True)
        if wanted := supervision.rearmed(flow, feed.left == 0):
            yield from operation.ask(wanted)
        self._secured_in_motion = False
        yield from supervision.unwatch()
        yield from self._outputs.restore(operation, feed.sent - feed.at_most)
        if operation.slept:
            return  # this process was suspended during these questions: the run has to be held again
        if self._told:
            yield from operation.ask(f"%{100.0 * operation.override:g}")
        yield from supervision.begin()
        if operation.slept:
            return
        yield from operation.ask("R")
        operation.settled = -math.inf
        self.refilling = False
        self._told.clear()
        operation.go(Event.RESUME)

    def _stays_held(self, flow: Flow) -> bool:
        """Return True if a watched input does not allow the motion to continue, and report this."""
        told = self._supervision.held_by(flow)
        if told:
            self.refilling = False
            self.operation.remark(f"the hold continues: {told}", warning=True)
        return bool(told)

    def _stay_held(self, change: str) -> Script[None]:
        """Continue the hold because a change by another client was not undone, and report the change
        again.
        """
        self.refilling = False
        self._told.clear()
        yield from self.for_others(change)
