"""Tests of the inspection of a controller. Each single wrong setting gives one clear row and a refusal;
harmless differences don't.
"""

import re

import pytest
from runtime.virtual import World, prepared, robot_with, world_of
from simulator.machines import robot_machine

from yarclang.pipeline.settings import items_of
from yarclang.robot.actuation import from_counts
from yarclang.robot.description import load_robot
from yarclang.runtime.notices import Stop
from yarclang.runtime.pmac.inspection import inspect
from yarclang.runtime.pmac.messages import Ask, Control
from yarclang.runtime.pmac.performance import connect, end_what_runs, look, perform
from yarclang.runtime.state import Event, State

ROBOTS = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")


@pytest.fixture(scope="module", params=ROBOTS)
def world(request):
    return connected(request.param)


def connected(name="INDUSTRIAL6", **options):
    robot, machine = robot_machine(name, record=False)
    world = World(machine, **options)
    world.robot = robot
    world.perform(connect(world.operation))
    return world


def seen(world):
    return world.perform(inspect(world.operation, world.robot, items_of(world.robot)))


def the_error(world):
    """Return the only error of an inspection. Check that the guard PLC wasn't tested after it."""
    found = seen(world)
    assert found.joints is None or len(found.errors) == 1
    (error,) = found.errors
    assert all((error.found, error.wanted, error.remedy))
    assert not world.moving
    return error


def test_all_is_well(world):
    found = seen(world)
    assert found.errors == ()
    assert found.joints == pytest.approx(world.robot.home, abs=1e-8)
    assert {one.verdict for one in found.checked} == {"ok"}
    subjects = [one.subject for one in found.checked]
    assert len(subjects) == len(set(subjects))
    for word in ("controller", "coordinate system 1", "guard PLC 29", "PLC 0", "I42", "I5195", "motor 6"):
        assert any(subject.startswith(word) for subject in subjects), word
    # After the test of the guard PLC, everything is as before.
    assert world.say("P8100") == ("0",)
    assert world.say("&1%") == ("100",)


@pytest.mark.parametrize("name", ROBOTS)
def test_what_changes_the_meaning_of_a_program_is_looked_at(name):
    robot = load_robot(name).value
    asked = {item.question for item in items_of(robot)}
    for motor in robot.controller.motors:
        assert {f"I{motor}{number:02d}" for number in (8, 13, 14, 15, 16, 17, 19, 20, 21, 22, 90)} <= asked
        assert {f"#{motor}->", f"M{motor}61->", f"M{motor}62->"} <= asked
    assert {
        "I5",
        "I8",
        "I10",
        "I42",
        "I5113",
        "I5150",
        "I5194",
        "I5195",
        "LIST PLC 0",
        "LIST PLC 29",
    } <= asked


ITEMS = {name: items_of(load_robot(name).value) for name in ROBOTS}


@pytest.mark.parametrize("name", ROBOTS)
def test_each_wrong_setting_is_one_row(name):
    """Each I-variable, axis definition and address of an M-variable that is wrong gives one row."""
    world = connected(name)
    for item in ITEMS[name]:
        if item.kind == "listing":
            continue
        before = world.say("&1" + item.question)[-1]
        question = item.question if item.question.endswith("->") else item.question + "="
        for wrong in wrong_values(item):
            world.say(f"&1{question}{wrong}")
            error = the_error(world)
            assert error.subject == item.subject
            assert wrong == "*" or same(error.found, wrong.removesuffix(",1")), (error, wrong)
            assert error.wanted == item.wanted
            assert f"yarc settings {name}" in error.remedy
        world.say(f"&1{question}{before}")
    assert not seen(world).errors


def wrong_values(item):
    if item.kind == "bits":
        return ["0", "1", "2"]
    if item.kind == "address":
        return [item.wanted.replace(":$00", ":$01"), "*"]
    if item.kind == "definition":
        factor = re.match(r"[\d.]+", item.wanted)[0]
        another = item.wanted.replace(factor, f"{float(factor) * 1.001:.4f}", 1)
        if "U" in item.wanted:
            return [another, f"{factor}U-{factor}V" if "+" in item.wanted else f"{factor}U+{factor}V"]
        return [another, item.wanted.replace(factor, factor + "0", 1) + "+1"]
    value = float(item.wanted)
    if re.fullmatch(r"I[2-6]\d\d", item.question):
        # Motors 2 to 6 are checked like motor 1, so one wrong value is enough.
        return [f"{value + max(1.0, abs(value)) * 1e-4:.6f}"]
    return [f"{value + max(1.0, abs(value)) * 1e-4:.6f}", f"{-value - 1:.4f}"]


def same(found, wrong):
    found, wrong = ([float(number) for number in re.findall(r"-?\d+\.?\d*", text)] for text in (found, wrong))
    return found == pytest.approx(wrong, abs=1e-4)


@pytest.mark.parametrize("number", [0, 29])
@pytest.mark.parametrize("change", ["another line", "a line less", "gone"])
def test_each_wrong_plc_is_one_row(number, change):
    world = connected()
    lines = list(world.say(f"LIST PLC {number}"))[:-1]
    if change == "another line":
        lines[1] = lines[1].replace("P", "P1", 1)
    elif change == "a line less":
        del lines[1 if number == 0 else 3]
    else:
        lines = []
    for line in (f"OPEN PLC {number} CLEAR", *lines, "CLOSE", f"ENABLE PLC {number}"):
        world.say(line)
    error = the_error(world)
    assert error.subject == f"PLC {number}"
    assert error.found == ("empty" if change == "gone" else "another program")


def test_a_plc_that_never_was_is_one_row():
    world = connected()
    world.say("CLEAR PLC 29")
    error = the_error(world)
    assert error.subject == "PLC 29"
    assert "ERR003" in error.found


def test_a_disabled_guard_is_found_by_trying_it():
    world = connected()
    world.say("DISABLE PLC 29")
    error = the_error(world)
    assert error.subject == "guard PLC 29"
    assert error.found == "armed, but it doesn't react"
    assert world.say("P8100") == ("0",)


MOTORS = {
    "open-loop": (("#3K",), "motor 3", "it is open-loop"),
    "not activated": (("I300=0",), "motor 3", "Ixx00"),
    "following error": (("I324=$400000", "I311=16"), "motor 3", "following error"),
    "amplifier": (("I224=$400000",), "motor 2", "amplifier"),
}


@pytest.mark.parametrize("kind", MOTORS)
def test_each_motor_in_trouble_is_one_row(kind):
    lines, subject, words = MOTORS[kind]
    world = connected()
    for line in lines:
        world.say(line)
    if kind == "following error":
        world.machine.disturb(3, 100.0)
    if kind == "amplifier":
        world.machine.fault_amplifier(2)
    error = the_error(world)
    assert error.subject == subject
    assert words in error.found
    assert error.wanted == "closed-loop, homed, without a fault"


def test_a_motor_that_is_not_homed_is_one_row():
    world = connected()
    world.say("#4J=1000")
    world.machine.advance(1.0)
    world.say("I423=1")
    world.say("#4HM")
    world.machine.advance(0.1)
    world.say("#4J/")
    world.machine.advance(1.0)
    error = the_error(world)
    assert error.subject == "motor 4"
    assert "homed" in error.found


def test_a_motor_at_a_limit_is_one_row():
    world = connected()
    world.say("#2J+")
    world.machine.advance(0.5)
    world.machine.set_limit_switch(2, 1, True)
    world.machine.advance(2.0)
    error = the_error(world)
    assert error.subject == "motor 2"
    assert "positive limit" in error.found


def test_a_killed_robot_has_a_row_for_each_motor():
    world = connected()
    world.machine.control(11)
    found = seen(world)
    assert [error.subject for error in found.errors] == [f"motor {n}" for n in range(1, 7)]


def test_a_large_following_error_is_a_warning():
    world = connected()
    world.say("I112=16")
    world.machine.disturb(1, 20.0)
    found = seen(world)
    assert found.errors == ()
    assert [one.subject for one in found.checked if one.verdict == "warning"] == ["motor 1"]


def test_a_motor_that_moves_is_one_row():
    world = connected()
    world.say("#5J+")
    found = seen(world)
    (error,) = found.errors
    assert (error.subject, error.found) == ("coordinate system 1", "it moves")


def test_a_running_program_is_one_row_and_is_not_disturbed():
    job, _ = prepared()
    world = world_of(job)
    world.robot = job.robot
    for line in ("OPEN PROG 7 CLEAR", "LINEAR", "TM3000", "X5", "X0", "CLOSE", "&1B7R"):
        world.say(line)
    world.machine.advance(1.0)
    (error,) = seen(world).errors
    assert (error.subject, error.found) == ("coordinate system 1", "it moves")
    assert world.moving
    world.machine.advance(10.0)
    assert not seen(world).errors


def test_a_program_that_the_guard_holds_is_one_row_until_it_is_ended():
    """A program that the guard PLC holds, because the computer has died, gives one row until it is ended."""
    job, _ = prepared(tm=20)
    world = world_of(job)
    script = perform(world.operation, job)
    world.at.append((world.now + 1.0, lambda: 1 / 0))
    with pytest.raises(ZeroDivisionError):
        world.perform(script)
    world.machine.advance(5.0)
    world.now = world.machine.now
    assert world.say("P8104") == ("2",)
    # Another process inspects the controller.
    again = World(world.machine)
    again.robot = job.robot
    ahead = again.say("PR")
    again.perform(connect(again.operation))
    (error,) = seen(again).errors
    assert error.found == "an unfinished program is held, or waits for lines"
    assert "yarc stop" in error.remedy
    assert again.say("PR") == ahead, "nothing that was asked was stored"
    joints = again.perform(end_what_runs(again.operation, job.robot, abort=False))
    assert joints == pytest.approx(from_counts(job.robot, again.stands(job.robot)))
    assert not seen(again).errors


@pytest.mark.parametrize("at", [0.3, 2.0])
def test_lines_of_a_stopped_program_do_not_spoil_the_guards_trial(at):
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.order(Stop(), at)
    assert not world.perform(perform(world.operation, job)).well
    world.prepare(job.robot)


def test_lines_that_somebody_else_left_do_not_either():
    world = connected()
    for line in ("&1DEFINE ROT 200", "B0", "OPEN ROT", *["X0"] * 30, "CLOSE"):
        world.say(line)
    assert world.say("M8116") == ("1",)
    assert not seen(world).errors


KINDS = {
    "an older PMAC": ({"CID": b"602191\r\x06", "TYPE": b"PMAC1\r\x06"}, "PMAC1 (CID 602191)"),
    "a Power PMAC": ({"CID": b"\x07ERR003\r"}, "ERR003"),
}


@pytest.mark.parametrize("kind", KINDS)
def test_another_controller_is_one_row(kind):
    replies, words = KINDS[kind]
    world = connected()
    world.spoil = lambda request, reply: (
        replies.get(request.line, reply) if isinstance(request, Ask) else reply
    )
    error = the_error(world)
    assert error.subject == "controller"
    assert words in error.found
    assert "Turbo" in error.wanted


@pytest.mark.parametrize("identity", ["602404", "602413", "603382"])
def test_each_turbo_is_known(identity):
    world = connected()
    world.spoil = lambda request, reply: (
        identity.encode() + b"\r\x06"
        if request == Ask("CID")
        else b"SOMETHING\r\x06"
        if request == Ask("TYPE")
        else reply
    )
    assert not seen(world).errors


def harmlessly(request, reply):
    """Return the same reply in another notation."""
    line = request.line if isinstance(request, Ask) else ""
    text = reply.decode("ascii", "replace")
    body = text.removesuffix("\r\x06")
    if re.fullmatch(r"(I\d+)+", line):
        body = "\r".join(otherwise(item) for item in body.split("\r"))
    elif re.fullmatch(r"#\d+->", line):
        terms = re.findall(r"[+-]?[^+-]+", body)
        body = " ".join(term if term[0] in "+-" else "+" + term for term in reversed(terms)).lower()
        body = body.replace("1111.1111", "1111.11110")
    elif re.fullmatch(r"M\d+->", line):
        body = body.replace(":$00", ":$").replace(",16,1", ",16")
    elif line.startswith("LIST"):
        body = (
            body.replace("RETURN", "RET")
            .replace("ENDIF", "ENDI")
            .replace("IF(", "IF (")
            .replace("32)", "32.0)")
        )
        body = body.replace("=1)", " = 1 )").replace("3555.5556", "3555.55560")
    else:
        return reply
    return body.encode() + b"\r\x06"


def otherwise(number):
    value = float(int(number[1:], 16)) if number.startswith("$") else float(number)
    if value == int(value) and value > 100:
        return f"${int(value):X}"
    return f"{value:.7f}"


@pytest.mark.parametrize("name", ROBOTS)
def test_numbers_spaces_and_the_order_of_terms_do_not_matter(name):
    world = connected(name)
    changed = []

    def spoil(request, reply):
        other = harmlessly(request, reply)
        changed.append(other != reply)
        return other

    world.spoil = spoil
    assert seen(world).errors == ()
    assert sum(changed) > 20


@pytest.mark.parametrize(
    "found",
    [
        "",
        "0",
        "I",
        "X",
        "29308.7083Y",
        "29308.7083Y-29308.7083Z",
        "29308.7083Y+29308.7083Z+5",
        "29308.72Y+29308.7083Z",
        "29308.7083Y+29308.7083Z+1Q",
    ],
)
def test_other_definitions_are_not_the_same(found):
    world = connected()
    world.spoil = lambda request, reply: found.encode() + b"\r\x06" if request == Ask("#3->") else reply
    assert the_error(world).subject == "axis definition of motor 3"


@pytest.mark.parametrize("found", [b"what\r\x06", b"\x06", b"1\r2\r3\r\x06", b"1_000\r\x06", b"nan\r\x06"])
def test_nonsense_is_a_row_and_not_a_crash(found):
    world = connected()
    world.spoil = lambda request, reply: (
        found if isinstance(request, Ask) and request.line.startswith("I5") else reply
    )
    errors = seen(world).errors
    assert errors
    assert all(error.subject.startswith("I") for error in errors)


def test_a_connection_that_is_lost_meanwhile_is_told():
    world = connected()
    world.spoil = lambda request, reply: b"\x12" if request == Ask("#3->") else reply
    from yarclang.runtime.actions import Trouble

    with pytest.raises(Trouble, match="lost while checking"):
        world.perform(look(world.operation, world.robot, items_of(world.robot)))


def test_a_look_without_errors_clears_a_fault():
    world = connected()
    world.operation.go(Event.FAULT)
    world.say("#3K")
    assert world.perform(look(world.operation, world.robot, items_of(world.robot))).errors
    assert world.operation.state is State.FAULT
    world.say("#3J/")
    assert not world.perform(look(world.operation, world.robot, items_of(world.robot))).errors
    assert world.operation.state is State.STOP


def test_nothing_is_asked_that_moves():
    world = connected()
    seen(world)
    asked = [
        line
        for line in world.asked
        if not re.fullmatch(r"(I\d+)+|([M#]\d+->)+|LIST PLC \d+|(M\d61)+(I\d+)+|\??", line)
    ]
    assert set(asked) <= {
        "I6=1 I3=2", "CLOSE", "CID", "TYPE", "&1??", "CLOSE ALL", "M8116", "P8100=1", "P8100", "P8100=0",
            "&1A",
        "P8103", "I5112=136 P8104=1", "I5112=136 P8104", "P8104", "P8103P8105", "P8104=0",
    }  # fmt: skip
    assert {sent.request.character for sent in world.sent if isinstance(sent.request, Control)} == {"\x0c"}


def test_two_groups_of_motors_are_looked_at(tmp_path):
    """A robot on motors 5 to 10, which a single ^B doesn't report."""
    robot, world = robot_with(tmp_path, motors=range(5, 11))
    world.robot = robot
    world.perform(connect(world.operation))
    assert not seen(world).errors
    world.say("#10K")
    assert the_error(world).subject == "motor 10"
