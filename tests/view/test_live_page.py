"""Tests of the page of a running robot, without a browser: its updates, and finding the robot."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from view.stages import EXAMPLES
from view.test_of_live import Q, cell_of, robot_of, status

from yarclang.cli.yarc import main
from yarclang.coordinator.describing import joints_by_name
from yarclang.coordinator.messages import events
from yarclang.coordinator.messages.replies import NamedSignal, PartPlace, Parts, Surroundings
from yarclang.robot.description import load_robot
from yarclang.runtime.actions import Trouble
from yarclang.runtime.transports.private import ControlError
from yarclang.runtime.transports.runs import Run
from yarclang.view import colours, reaching
from yarclang.view.bodies import shapes_beside
from yarclang.view.door import Door, opened
from yarclang.view.live_page import LivePage
from yarclang.view.of_live import Live
from yarclang.view.panel import Order
from yarclang.view.picture import Picture
from yarclang.view.reaching import Place, Whose


@pytest.fixture(scope="module")
def server():
    with opened(Door("127.0.0.1", 0)) as server:
        yield server


@pytest.fixture
def given():
    return []


@pytest.fixture
def page(server, given):
    robot = robot_of()
    page = LivePage(server, given.append)
    page.attach(Live(robot, status(robot, Q)), Place(robot, cell_of("12_machine_cell.toml")), "simulated")
    page.show_around(around())
    return page


def around(value=0.0, fixed=""):
    door, grip = (
        NamedSignal(name=name, variable=variable, value=value)
        for name, variable in (("DOOR", "M11"), ("GRIP", "M1"))
    )
    return Surroundings(robot="", cell=None, inputs=(door,), outputs=(grip,), fixed=fixed)


def box(page):
    return page._panel._boxes["DOOR"]


def tick(page, value):
    """Switch the input as a click in the browser does."""
    page._panel._ticked("DOOR", SimpleNamespace(client_id=3, target=SimpleNamespace(value=value)))


def test_only_what_moves_is_drawn(page, monkeypatch):
    moves = []
    monkeypatch.setattr(page._picture, "stand_at", moves.append)
    for _ in range(10):
        page.draw()
    assert len(moves) == 1
    robot = robot_of()
    page._live.hear(events.Position(time_s=0.0, joints=joints_by_name(robot, Q + 0.1), done_s=0.0))
    page.draw()
    page.draw()
    assert len(moves) == 2
    assert moves[1] == pytest.approx(Q + 0.1, abs=1e-6)


def test_a_robot_that_is_away_is_grey_and_comes_back(page):
    page.draw()
    node, item = page._picture._bodies["MACHINE_BED"][0]
    page.lose("it has ended")
    assert tuple(node.color) == colours.STALE
    assert page._picture._written.text == "not connected"
    assert "it has ended" in page._panel._lost._shown
    assert box(page).disabled
    page.attach(Live(robot_of(), status(robot_of(), Q)), page._place, "told by another")
    assert tuple(node.color) == tuple(item.colour)
    assert page._picture._written is None
    assert page._panel._lost._shown == ""
    assert "told by another" in page._panel._head._shown
    assert not box(page).disabled


def test_a_click_becomes_an_order_and_the_robot_has_the_last_word(page, given):
    tick(page, True)
    (order,) = given
    assert (order.kind, order.value, order.more) == ("input", "DOOR", True)
    page.show_around(around(1.0))
    assert box(page).value is True
    assert len(given) == 1  # a view that only follows the robot gives no orders
    page.refuse("DOOR", Trouble("run owns the robot", code="Y1611"))
    page._count = 0
    page.draw()
    assert "DOOR isn&#x27;t set: run owns the robot (Y1611)" in page._panel._said._shown


def test_inputs_of_a_real_controller_are_fixed(page):
    page.show_around(around(fixed="they are set there (Y1619)"))
    assert box(page).disabled
    assert "Y1619" in page._panel._fixed._shown


def test_another_robot_is_told_of(page):
    other = robot_of("TRACKED_MANIPULATOR")
    page.attach(Live(other, status(other, other.home)), Place(other, None), "simulated")
    page.draw()
    words = "another robot is served here now: TRACKED_MANIPULATOR with 6 joints, not INDUSTRIAL6 with 6"
    assert words in page._panel._head._shown
    assert "MACHINE_BED" not in page._picture._bodies


def test_a_robot_with_other_joints_in_the_place_of_one(page, tmp_path):
    """Another robot takes the place of the first one, and some of its joints have the same names."""
    arguments = ["robot", "new", str(EXAMPLES / "scara.urdf"), "--yes", "-o", str(tmp_path / "r")]
    assert CliRunner().invoke(main, arguments).exit_code == 0
    other = load_robot(str(tmp_path / "r")).value
    assert other.size != 6
    page.draw()
    page._live.hear(events.Position(time_s=0.0, joints=joints_by_name(other, other.home), done_s=0.0))
    page.draw()  # messages from the new robot, before the page is attached to it
    page.attach(Live(other, status(other, other.home + 0.01)), Place(other, None), "simulated")
    page.draw()
    assert f"with {other.size} joints, not INDUSTRIAL6 with 6" in page._panel._head._shown
    assert page._drawn == pytest.approx(other.home + 0.01)
    page.lose("it has ended")
    page.attach(Live(robot_of(), status(robot_of(), Q)), Place(robot_of(), None), "simulated")
    page.draw()
    assert page._drawn == pytest.approx(Q)


def test_what_is_hidden_is_hidden(page):
    from yarclang.view.panel import Order

    page.take(Order("group", "obstacle", False))
    assert not page._picture._bodies["MACHINE_BED"][0][0].visible


def runs(*names):
    return tuple(Run(name, name.partition("-")[0], int(name.partition("-")[2]), None) for name in names)


@pytest.fixture
def there(monkeypatch):
    def set_(*names):
        for module in (reaching, reaching.the_run.__globals__):
            if isinstance(module, dict):
                monkeypatch.setitem(module, "find_runs", lambda: runs(*names))
            else:
                monkeypatch.setattr(module, "find_runs", lambda: runs(*names))

    return set_


def test_which_robot_is_found(there):
    there()
    with pytest.raises(ControlError, match="no robot runs on this computer"):
        Whose().first()
    there("a-1", "b-2")
    with pytest.raises(ControlError, match="several"):
        Whose().first()
    assert Whose("b").first().name == "b-2"
    there("b-3")
    assert Whose("b-2").again(runs("b-2")[0]).name == "b-3"
    there("a-1")
    with pytest.raises(ControlError, match="b isn't served again yet"):
        Whose().again(runs("b-2")[0])
    there("b-3", "b-4")
    with pytest.raises(ControlError, match="several serve b now"):
        Whose().again(runs("b-2")[0])


def test_the_joints_of_another_robot_move_nothing(page):
    page.draw()
    before = page._drawn
    page._live.hear(events.Position(time_s=0.0, joints={"X": 3.0}, done_s=0.0))
    page.draw()
    assert np.array_equal(page._drawn, before)


def test_a_part_is_drawn_where_it_is_and_what_was_hidden_stays_hidden(server, given):
    robot, cell = robot_of(), cell_of("06_palletising.toml")
    page = LivePage(server, given.append)
    live = Live(robot, status(robot, Q))
    page.attach(live, Place(robot, cell), "simulated")
    page.draw()
    nodes = page._picture._parts._nodes
    assert nodes
    assert all(node.name.startswith("/joint_0/") for node, _ in nodes)
    page.take(Order("group", "names", False))
    page.take(Order("group", "zone", False))
    (kind,) = {one.body.name for one in cell.parts}
    grip = next(name for name, one in cell.outputs.items() if one.grip is not None)
    pose = tuple(map(tuple, np.eye(4).tolist()))
    place = PartPlace(name=f"{kind} 2", held=grip, sure=True, pose=pose)
    live.parts.told(Parts(parts=(place,), moved=True, doubt=None, findings=()))
    page.draw()
    nodes = page._picture._parts._nodes
    assert {node.name.split("/")[1] for node, _ in nodes} == {f"joint_{robot.size}"}
    assert [node.visible for node, _ in nodes] == [True, False]  # the part and its name
    assert f"{kind} 2" in live.html(page._stage, Q)
    # another cell makes the page draw everything again
    page.attach(Live(robot, status(robot, Q)), Place(robot, cell_of("12_machine_cell.toml")), "simulated")
    page.draw()
    assert {"names", "zone", "other_axes"} <= page._picture.switches.hidden
    assert page._picture._parts._nodes == []


def test_collision_shapes_are_seen_if_somebody_wants_them(page, server):
    """Collision shapes are shown on demand for links with visual meshes. A robot without visual meshes is
    drawn by its collision shapes, and has no switch for them.
    """
    nodes = [node for node, _ in page._picture.switches._nodes["shape"]]
    robot = robot_of()
    assert len(nodes) == len(robot.shapes)
    assert [node.visible for node in nodes] == [False] * len(nodes)
    page.take(Order("group", "shape", True))
    assert all(node.visible for node in nodes)
    named = {
        one[0] for one in page._picture._bodies.items() if any(item.kind == "shape" for _, item in one[1])
    }
    assert named == {one.link for one in robot.shapes}
    stage = page._stage
    plain = replace(stage, items=tuple(one for one in stage.items if one.kind != "robot"))
    assert shapes_beside(robot, plain.items) == ()
    assert "shape" not in Picture(server, plain).switches.groups
