"""Execution of a client's orders. Only this module turns messages into calls."""

from __future__ import annotations

import inspect
import os
from collections import OrderedDict
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import yarclang
from yarclang.coordinator.client import Client
from yarclang.coordinator.course import course_described
from yarclang.coordinator.describing import (
    joints_by_name,
    offer_described,
    parts_described,
    program_described,
    signals_described,
    way_described,
)
from yarclang.coordinator.ending import ended_described, placed, run_described
from yarclang.coordinator.health import frames_of, health_of
from yarclang.coordinator.held import Held
from yarclang.coordinator.live.steered import Steered
from yarclang.coordinator.loading import Source
from yarclang.coordinator.messages import orders, replies, wants
from yarclang.coordinator.messages.findings import finding_messages
from yarclang.coordinator.messages.message import VERSION
from yarclang.coordinator.messages.orders import Order
from yarclang.coordinator.messages.replies import Reply
from yarclang.coordinator.offers import Offer
from yarclang.coordinator.programs import Loaded
from yarclang.coordinator.recovering import recovery_described
from yarclang.coordinator.servicing import Servicing, wrong_in
from yarclang.coordinator.undertaking import Undertaking
from yarclang.diagnostics import Diagnostic, Result
from yarclang.pipeline.cells import holds_still, is_same_file
from yarclang.pipeline.inputs import Options
from yarclang.runtime.actions import Trouble
from yarclang.runtime.notices import Hold
from yarclang.runtime.state import State
from yarclang.transforms import pose_matrix
from yarclang.units import DEG, MM

if TYPE_CHECKING:
    from yarclang.coordinator.coordinator import Coordinator

T = TypeVar("T")
R = TypeVar("R", bound=Reply)

_KEPT = 32
"""Number of offers that are kept for a later order `go`, and of programs that are kept for a later order
`run`. If there are more, the oldest one is dropped.
"""


class Desk:
    """Executes the orders that one client gives to a coordinator.

    Args:
        coordinator: the robot's coordinator.
        client: the client.

    Attributes:
        client: the client.
        listens: the events that the client wants: none yet, all except positions, or all.
    """

    def __init__(self, coordinator: Coordinator, client: Client) -> None:
        self.client = client
        self._coordinator = coordinator
        self._offers: OrderedDict[int, Offer] = OrderedDict()
        self._programs: OrderedDict[int, tuple[Loaded, int]] = OrderedDict()
        self._steered = Steered(client, coordinator.engine.session.now, lambda: coordinator.rests)
        self._held = Held(coordinator, client.name)
        self._servicing = Servicing(coordinator, client.name)
        self._stops: int | None = None
        self._stops_at_own = coordinator.stops
        self._handlers: dict[type[Order[Any]], Callable[[Any], Any]] = {
            orders.AskStatus: lambda _: status_of(coordinator),
            orders.Hold: lambda _: self._ordered(client.motion.hold),
            orders.Resume: lambda order: self._resume(order.value),
            orders.Step: lambda _: self._resume(),
            orders.Stop: lambda _: self._ordered(client.motion.stop),
            orders.Abort: lambda _: self._ordered(client.motion.abort),
            orders.Override: lambda order: self._ordered(lambda: client.motion.override(order.percent)),
            orders.Own: lambda order: _done_reply(lambda: self._own(order)),
            orders.Give: lambda order: _done_reply(lambda: client.session.give(order.to)),
            orders.Release: lambda _: self._release(),
            orders.Clear: lambda _: self._clear(),
            orders.Look: lambda _: self._look(),
            orders.Connect: lambda _: self._connect(),
            orders.Enable: lambda _: self._servicing.enable(),
            orders.Disable: lambda _: self._servicing.disable(),
            orders.AskHoming: lambda _: self._servicing.searches(),
            orders.Home: self._home,
            orders.AskSettings: lambda _: self._servicing.compared(),
            orders.SendSettings: lambda order: self._servicing.send(order.known),
            orders.SaveSettings: lambda _: self._servicing.save(),
            orders.AskPlace: self._place,
            orders.AskFrames: lambda _: coordinator.plan(frames_of, coordinator),
            orders.AskHealth: lambda _: health_of(coordinator),
            orders.Read: self._read,
            orders.SetOutput: self._set,
            orders.SetInput: lambda order: _value(client.signals.set_input(order.name, order.value)),
            orders.AskSurroundings: lambda _: self._surroundings(),
            orders.AskParts: lambda order: parts_described(client.parts.where(order.cell)),
            orders.AskModel: lambda _: coordinator.beside(coordinator.scenes.model),
            orders.AskScene: lambda _: self._scene(),
            orders.PlacePart: self._place_part,
            orders.AskDeclarations: lambda _: self._declarations(),
            orders.Adopt: self._adopt,
            orders.Offer: lambda order: self._offered(client.motion.offer(order.text)),
            orders.Fill: self._fill,
            orders.OfferBack: lambda _: self._offered(client.motion.offer_back()),
            orders.OfferRecovery: self._recovered,
            orders.Go: self._go,
            orders.Keep: lambda _: _done_reply(self._held.keep),
            orders.Load: self._load,
            orders.AskWay: self._way,
            orders.AskCourse: lambda order: coordinator.plan(
                course_described, self._loaded(order.program), order.samples
            ),
            orders.Run: self._run,
            orders.Save: self._save,
            orders.Steer: lambda order: _done_reply(lambda: self._steered.set(order)),
            orders.Leave: lambda _: _done_reply(self._steered.stop),
            **dict.fromkeys(wants.KINDS, self._steered.take),
        }

    async def answer(self, order: Order[R]) -> R:
        """Carry an order out.

        Raises:
            NotOwner: only the robot's owner may give this order.
            Trouble: the order can't be carried out now.
        """
        made = self.answer_now(order)
        answer: R = await made if inspect.iscoroutine(made) else made
        self._coordinator.tell_scene()
        return answer

    def answer_now(self, order: Order[R]) -> Any:
        """Begin to carry an order out, and return its reply, or an awaitable for the reply.

        Stops, holds and changes of the override are already carried out when this returns.
        """
        return self._handlers[type(order)](order)

    def stop_steering(self) -> None:
        """Bring a live motion of this client to rest, if any."""
        self._steered.stop()

    def keep(self, loaded: Loaded, generation: int | None = None) -> replies.ProgramDescribed:
        """Keep a program that was loaded in this process, so that the client can run it by its number.

        Args:
            loaded: the program.
            generation: the planner's `generation` when the program was loaded; None: the current one.
        """
        number = next(self._coordinator.numbers)
        known = self._coordinator.planner.generation if generation is None else generation
        _keep(self._programs, number, (loaded, known))
        return program_described(number, loaded)

    def offer_of(self, number: int) -> Offer | None:
        """Return an offer that was made for this client. For callers in the same process."""
        return self._offers.get(number)

    def loaded_of(self, number: int) -> Loaded | None:
        """Return a program that was loaded for this client. For callers in the same process."""
        found = self._programs.get(number)
        return None if found is None else found[0]

    # immediate actions

    def _ordered(self, order: Callable[[], object]) -> replies.Taken:
        state = self._coordinator.state
        order()
        return replies.Taken(state=state)

    def _resume(self, answer: int | None = None) -> replies.Taken:
        coordinator = self._coordinator
        if self._held.rests:
            raise Trouble("it moves only while its button is pressed", "hold the button", "")
        operation = coordinator.engine.operation
        if coordinator.state is State.MOVE and not coordinator.paused and Hold() not in operation.orders:
            raise Trouble("the robot isn't held: there is nothing to resume", code="")
        return self._ordered(lambda: self.client.motion.resume(answer))

    def _own(self, order: orders.Own) -> None:
        self.client.session.own(shared=order.shared)
        self._stops_at_own = self._coordinator.stops

    def _release(self) -> replies.Released:
        coordinator = self._coordinator
        if not self.client.session.owns or coordinator.under_way:
            self.client.session.release()
            return replies.Released(log=None)
        self.client.session.release()
        log = coordinator.engine.close_log()
        if log is None:
            return replies.Released(log=None)
        return replies.Released(
            log=replies.LogTold(path=str(log.path), problem=log.problem, help=log.remedy, lost=bool(log.loss))
        )

    async def _clear(self) -> replies.Done:
        await self.client.motion.clear()
        return replies.Done()

    async def _connect(self) -> replies.Done:
        await self._coordinator.engine.retry()
        return replies.Done()

    async def _home(self, order: orders.Home) -> replies.Ended:
        self._coordinator.check_owner(self.client.name, "to home the robot")
        ended = await self._held.carry_out(self._servicing.home(order.motors))
        return ended_described(ended, self.client.robot, self._coordinator.state)

    async def _look(self) -> replies.Looked:
        found = await self._coordinator.engine.look_again()
        return replies.Looked(
            checked=len(found.checked),
            wrong=wrong_in(found),
        )

    # questions

    async def _place(self, order: orders.AskPlace) -> replies.Place:
        made = await self.client.motion.where(order.base, order.moving)
        joints = await self.client.motion.stands() if made.value is None else made.value.joints
        pose = None if made.value is None else made.value.base_from_moving
        return replies.Place(
            joints=joints_by_name(self.client.robot, joints),
            exact=tuple(joints.tolist()),
            pose=None if pose is None else tuple(map(tuple, pose.tolist())),
            findings=finding_messages(made.diagnostics),
        )

    async def _read(self, order: orders.Read) -> replies.Value:
        return _value(await self.client.signals.read(order.name))

    async def _set(self, order: orders.SetOutput) -> replies.Value:
        return _value(await self.client.signals.set(order.name, order.value))

    def _fill(self, order: orders.Fill) -> replies.Filled:
        return replies.Filled(
            values=self._coordinator.values.take(order.values, order.number, self.client.name)
        )

    async def _surroundings(self) -> replies.Surroundings:
        coordinator, signals = self._coordinator, self.client.signals
        around = coordinator.around
        await coordinator.look_around(waits=False)
        surroundings = around.look() if around.is_current else await coordinator.plan(around.look)
        values = await signals.values((*surroundings.inputs.values(), *surroundings.outputs.values()))
        return replies.Surroundings(
            robot=str(coordinator.robot.folder),
            cell=surroundings.cell,
            inputs=signals_described(surroundings.inputs, values),
            outputs=signals_described(surroundings.outputs, values),
            fixed=signals.fixed,
        )

    async def _scene(self) -> replies.Scene:
        await self._coordinator.look_around(waits=False)
        scene: replies.Scene = await self._coordinator.beside(self._coordinator.scenes.scene)
        return scene

    async def _place_part(self, order: orders.PlacePart) -> replies.Parts:
        parts, name = self.client.parts, None if order.part is None else order.part.upper()
        if order.at == "file":
            return parts_described(await parts.as_filed(name))
        if name is None:
            raise Trouble(
                "all parts together can only be put back to their places in the cell's file",
                "name one",
                "Y1601",
            )
        if order.at == "gone":
            return parts_described(await parts.gone(name))
        return parts_described(
            await parts.put(
                name,
                order.frame,
                pose_matrix((*(one * MM for one in order.pose[:3]), *(one * DEG for one in order.pose[3:]))),
            )
        )

    def _declarations(self) -> replies.Declarations:
        lines = self._coordinator.lines
        return replies.Declarations(declarations=tuple(lines.declarations), count=lines.count)

    async def _adopt(self, order: orders.Adopt) -> replies.Adopted:
        made = await self.client.session.adopt(order.declarations)
        return replies.Adopted(holds=made.value is not None, findings=finding_messages(made.diagnostics))

    # motions

    async def _offered(self, making: Any) -> replies.Offered:
        offer: Result[Offer] = await making
        found = finding_messages(offer.diagnostics)
        if offer.value is None:
            return replies.Offered(offer=None, findings=found)
        _keep(self._offers, offer.value.number, offer.value)
        return replies.Offered(offer=offer_described(offer.value, self.client.robot), findings=found)

    async def _recovered(self, order: orders.OfferRecovery) -> replies.Recovery:
        loaded = self._loaded(order.program)
        await self._check_cell(order.program)
        made = await self.client.motion.offer_recovery(loaded)
        if made.offer is not None:
            _keep(self._offers, made.offer.number, made.offer)
        return recovery_described(made, self.client.robot)

    async def _go(self, order: orders.Go) -> replies.Ended:
        self._coordinator.check_owner(self.client.name, "to move the robot")
        offer = self._offers.get(order.offer)
        if offer is None:
            raise Trouble(f"there is no offer {order.offer}", "request it again", "Y1613")
        going = self.client.motion.go(offer)
        ended = await (self._held.carry_out(going) if order.held else going)
        return ended_described(ended, self.client.robot, self._coordinator.state)

    async def _load(self, order: orders.Load) -> replies.Loaded:
        generation = await self._coordinator.look_around()
        tolerance, cell = order.tolerance, self._coordinator.cell
        if order.cell and cell and not is_same_file(Path(order.cell), Path(cell)):
            message = f"the robot is served with the cell {cell}, the command line gives {order.cell}"
            conflict = Diagnostic(
                "Y1373", message, help="leave --cell out, or serve the robot with this cell"
            )
            return replies.Loaded(program=None, findings=finding_messages((conflict,)))
        source = Source(
            order.file,
            order.text,
            order.first,
            order.by_steps,
            Options(
                start=order.start,
                tm=order.tm,
                tolerance=None
                if tolerance is None
                else (tolerance[0], tolerance[1] if len(tolerance) > 1 else None),
                cell=order.cell or cell,
            ),
            order.source,
            order.approach,
        )
        made = await self.client.files.load(source, here=order.here, as_now=not order.recover)
        # Convert the findings in the planning thread. Thousands of them would block this event loop, and
        # thereby delay a live motion.
        found = await self._coordinator.plan(finding_messages, made.diagnostics)
        program = None if made.value is None else self.keep(made.value, generation)
        return replies.Loaded(program=program, findings=found)

    async def _way(self, order: orders.AskWay) -> replies.Way:
        loaded = self._loaded(order.program)
        # From now on, a stop also cancels the run that is being prepared.
        self._stops = self._coordinator.stops
        await self._check_cell(order.program)
        here = await self._coordinator.stands()
        way = await self._coordinator.carrying.way_to_start(loaded, here)
        return way_described(way, self.client.robot, loaded.rest.start)

    async def _run(self, order: orders.Run) -> replies.Ended:
        coordinator = self._coordinator
        coordinator.check_owner(self.client.name, "to move the robot")
        loaded = self._loaded(order.program)
        stops = coordinator.stops if self._stops is None else self._stops
        self._stops = None
        if order.unless_stopped:
            stops = self._stops_at_own
        await self._check_cell(order.program)
        program = loaded.origins().program
        coordinator.around.know(program, loaded.around)
        if coordinator.surroundings is not None:
            coordinator.surroundings.know(program)
            if loaded.begins_within and loaded.assumed is not None and loaded.around is not None:
                # The run of this simulated robot begins within the program, so the robot must already hold
                # the parts that the program assumes there.
                coordinator.surroundings.place(loaded.assumed, loaded.around)
        undertaking = Undertaking(loaded, coordinator, order.times)
        ended = await self.client.motion.undertake(undertaking, approach=order.approach, stops=stops)
        ended, resting = await coordinator.plan(placed, ended, loaded)
        coordinator.engine.ended = ended  # the log shows the place of a fault as well
        described: replies.Ended = await coordinator.plan(
            run_described, ended, resting, loaded, undertaking, coordinator.state
        )
        return described

    def _loaded(self, number: int) -> Loaded:
        loaded = self.loaded_of(number)
        if loaded is None:
            raise Trouble(f"there is no program {number}", "load it again", "Y1613")
        return loaded

    async def _check_cell(self, number: int) -> None:
        """Check that the cell is still the one with which a program was proved.

        Raises:
            Trouble: the cell has changed.
        """
        generation = await self._coordinator.look_around()
        loaded, known = self._programs[number]
        cell = loaded.around
        if generation == known and (cell is None or await self._coordinator.plan(holds_still, cell)):
            return
        what = f"the cell has changed since {loaded.name} was loaded and proved"
        raise Trouble(what, "load it again", "Y1613")

    def _save(self, order: orders.Save) -> replies.Saved:
        folder = None if order.folder is None else Path(order.folder)
        return replies.Saved(text=self.client.files.saved(folder))


def status_of(coordinator: Coordinator) -> replies.Status:
    """Return the coordinator's status as a message."""
    robot, progress, position = coordinator.robot, coordinator.progress, coordinator.position
    places = [None] * robot.size if position is None else (position / robot.axis_units).round(6).tolist()
    shown_progress = progress if coordinator.under_way else None
    log = coordinator.engine.run_log
    return replies.Status(
        program=coordinator.under_way or coordinator.name,
        robot=robot.name,
        controller=coordinator.address,
        state=coordinator.state,
        why=coordinator.why,
        command=replies.Command(title=shown_progress.command, line=shown_progress.line)
        if shown_progress and shown_progress.command
        else None,
        done=round(shown_progress.done_s, 3) if shown_progress else 0.0,
        left=round(shown_progress.left_s + coordinator.behind / max(coordinator.override / 100.0, 0.01), 3)
        if shown_progress
        else 0.0,
        override=round(coordinator.override, 6),
        joints=tuple(
            replies.Joint(name=name, position=place, unit=unit)
            for name, place, unit in zip(robot.joint_names, places, robot.axis_unit_names, strict=True)
        ),
        waiting=coordinator.waiting,
        pid=os.getpid(),
        since=coordinator.since,
        owner=coordinator.owner or None,
        clients=coordinator.clients,
        cell=coordinator.cell,
        log=None if log is None else str(log.path),
        log_lost="" if log is None else log.lost(),
        asks=coordinator.asks,
        wants=coordinator.values.wanted,
    )


def welcome(coordinator: Coordinator, client: Client) -> replies.Welcome:
    """Return the first message to a new client."""
    inspection = coordinator.inspection
    return replies.Welcome(
        version=VERSION,
        yarclang=yarclang.__version__,
        name=client.name,
        fingerprint=coordinator.robot.fingerprint,
        simulated=coordinator.simulated,
        serves=coordinator.serves,
        checked=0 if inspection is None else len(inspection.checked),
        folder=str(coordinator.planner.folder.absolute()),
        status=status_of(coordinator),
    )


def _done_reply(do: Callable[[], object]) -> replies.Done:
    do()
    return replies.Done()


def _value(result: Result[float]) -> replies.Value:
    return replies.Value(value=result.value, findings=finding_messages(result.diagnostics))


def _keep(entries: OrderedDict[int, T], number: int, entry: T) -> None:
    entries[number] = entry
    while len(entries) > _KEPT:
        entries.popitem(last=False)
