"""Tests of streaming of lines that don't move the robot (SETs). The controller executes them at once, so the
buffer empties faster than by moves.
"""

from dataclasses import replace

import pytest
from runtime.virtual import moved_along, prepared, well_behaved, world_of

from yarclang.pmac.variables import OUTPUTS_PLC
from yarclang.runtime.notices import Hold, Resume, Stop
from yarclang.runtime.pmac.loading import Loading, capacity_of, loading_of
from yarclang.runtime.pmac.performance import perform

BEGIN = "OUTPUT A M20\nDEFAULT {TCP} (mm,deg,s) {B}\n"
GROUPS = "".join(f"OUTPUT G{k} P{4000 + 20 * k}..P{4015 + 20 * k}\n" for k in range(4))
FAR = "P9010 MOVEJ 20 0 0 0 0 0 [6]\nP9020 MOVEJ 0 0 0 0 0 0 [6]\n"
NEAR = "P0001 MOVEJ 5 0 0 0 0 0 [2]\n"
SAY = 'P0002 SAY "x"\n'


def sets(count, first=100):
    return "".join(f"P{first + k:04d} SET A {'ON' if k % 2 else 'OFF'}\n" for k in range(count))


def clusters(count):
    """Return a program with `count` SETs before each of several short motions."""
    motions = [
        sets(count, 100 * n) + f"P{100 * n + 99:04d} MOVEJ {5 + 0.3 * (n % 2)} 0 0 0 0 0 [0.5]\n"
        for n in range(1, 9)
    ]
    return BEGIN + "P0001 MOVEJ 5 0 0 0 0 0 [3]\n" + "".join(motions)


def run(world, job):
    ended = world.perform(perform(world.operation, job))
    well_behaved(world)
    assert ended.well, ended.what
    return ended


def held_needlessly(world):
    return "buffer low" in world.words or "the guard PLC" in world.words


PROGRAMS = {
    "before the first move": BEGIN + sets(100) + FAR,
    "before the first move, in groups of outputs": GROUPS
    + BEGIN
    + "".join(f"P{10 * k + 10:04d} SET G{k} {k * 1000 + 7}\n" for k in range(4))
    + FAR,
    "before the first move after a barrier": BEGIN + NEAR + SAY + sets(100) + FAR,
    "after the last move": BEGIN + FAR.replace("P90", "P00") + sets(200),
    "between moves": clusters(20),
    "between moves, many": clusters(30),
}


@pytest.mark.parametrize("place", PROGRAMS)
def test_lines_without_moves_run_without_a_hold(place):
    job, plan = prepared(PROGRAMS[place])
    world = world_of(job, record=True, delay=0.002)
    since = world.now
    run(world, job)
    assert not held_needlessly(world)
    assert moved_along(world, job, plan, since) < 1.0


@pytest.mark.parametrize("count", [100, 700])
@pytest.mark.parametrize(
    "program",
    [BEGIN + NEAR + SAY + "{}" + 'P9000 SAY "y"\nP9010 MOVEJ 0 0 0 0 0 0 [2]\n', BEGIN + NEAR + SAY + "{}"],
    ids=["before a barrier", "at the end"],
)
def test_more_lines_than_the_buffer_has_room_for_and_no_move(program, count):
    """The buffer runs empty at once, but the robot is at rest on its path."""
    job, _ = prepared(program.replace("{}", sets(count)))
    parts = [leg.job for leg in job.legs if leg.job is not None]
    assert any(len(part.lines) > part.capacity for part in parts)
    world = world_of(job)
    world.say("M20->*")
    run(world, job)
    assert not held_needlessly(world)
    assert world.say("M20") == ("1",)


def test_a_buffer_too_small_for_the_lines_before_the_first_move_is_filled_again():
    """A text of an older compiler: its buffer doesn't have room for all lines before the first move."""
    job, plan = prepared(BEGIN + sets(100) + FAR)
    own = loading_of(job)
    marks = {
        f"I16={own.low}": "I16=5",
        f"I17={own.full}": "I17=10",
        f"DEFINE ROT {own.words}": "DEFINE ROT 480",
    }
    small = Loading(tuple(marks.get(line, line) for line in own.setup), 480, 5, 10)
    job = replace(job, own=small, capacity=capacity_of(job.robot, 480))
    assert job.capacity < 100
    world = world_of(job, record=True)
    since = world.now
    run(world, job)
    assert moved_along(world, job, plan, since) < 1.0


@pytest.mark.parametrize(("seed", "seconds"), [(0, 2.0), (5, 2.25)])
def test_positions_after_many_lines_without_moves_are_on_the_path(seed, seconds):
    """A fast motion follows lines that take no time, so many lines may be executed between two answers."""
    program = (
        BEGIN.replace("{TCP} ", "{TCP} [MIN] ")
        + f"P0010 MOVEJ 5 0 0 0 0 0 [{seconds:.2f}]\n"
        + "".join(f"P{30 + k:04d} SET A {'ON' if k % 2 else 'OFF'}\n" for k in range(40))
        + "P0900 MOVEJ_TOPP 30 0 0 0 0 0\nP0910 MOVEJ 0 0 0 0 0 0 [3]\n"
    )
    job, _ = prepared(program, tm=5)
    run(world_of(job, delay=0.002, seed=seed), job)


HOME = "P0030 MOVEJ 0 0 0 0 0 0 [2]\n"
SAFE = "OUTPUT A M20 OFF\nDEFAULT (deg,s)\n"


def test_safe_values_of_the_program_before_are_not_those_of_this_one():
    """The first program has a safe value for an output, the second has none: after a hold by the guard, the
    output stays as the second program has set it.
    """
    first, _ = prepared(SAFE + "P0010 SET A ON\n" + NEAR + HOME)
    job, _ = prepared(SAFE.replace(" OFF", "") + "P0010 SET A ON\n" + FAR)
    world = world_of(first)
    world.say("M20->*")
    run(world, first)
    assert f"DISABLE PLC {OUTPUTS_PLC}" not in world.asked
    world.prepare(job.robot)
    values = []
    world.do(lambda: world.say("&1H") or world.say("P8100=2"), 4.0)
    for after in (3.9, 4.5, 6.0):
        world.do(lambda: values.append(world.say("M20")), after)
    run(world, job)
    assert "the guard PLC has held the motion" in world.words
    assert f"DISABLE PLC {OUTPUTS_PLC}" in world.asked
    assert values == [("1",)] * 3


def test_a_program_with_safe_values_enables_their_plc_again():
    first, _ = prepared(SAFE.replace(" OFF", "") + "P0010 SET A ON\n" + NEAR + HOME)
    job, _ = prepared(SAFE + "P0010 SET A ON\n" + FAR)
    world = world_of(first)
    run(world, first)  # there is no such PLC yet: to disable it is no error
    run(world, job)
    switched = [line for line in world.asked if line.endswith(f"ABLE PLC {OUTPUTS_PLC}")]
    assert switched == [f"DISABLE PLC {OUTPUTS_PLC}", f"ENABLE PLC {OUTPUTS_PLC}"]


LAMP = (
    "OUTPUT A M20 OFF\nDEFAULT (deg,s)\nP0010 MOVEJ 10 0 0 0 0 0 [1.2]\nP0015 SET A ON\n"
    "P0020 MOVEJ 20 0 0 0 0 0 [4]\nP0030 SET A OFF\n"
)


class DeadError(Exception):
    """This computer has failed."""


@pytest.mark.parametrize("tm", [4, 10, 50])
@pytest.mark.parametrize("at", [2.0, 5.0, 5.15])
def test_outputs_are_safe_after_this_computer_has_failed(tm, at):
    """The watchdog or the guard holds, and PLC 28 sets the outputs."""
    job, _ = prepared(LAMP, tm=tm)
    world = world_of(job)
    world.say("M20->*")

    def fail():
        raise DeadError

    world.do(fail, at)
    with pytest.raises(DeadError):
        world.perform(perform(world.operation, job))
    world.machine.advance(8)
    assert world.say("M20") == ("0",)
    assert not world.moving


@pytest.mark.parametrize("stall", [2.0, 5.0])
def test_outputs_are_restored_after_a_hold_by_the_watchdog(stall):
    """This computer was suspended: the outputs got their safe values, and have those of the program again."""
    job, plan = prepared(LAMP, tm=10)
    world = world_of(job, record=True)
    world.say("M20->*")
    since, seen = world.now, []
    world.stall_at = [(since + stall, 1.5)]
    world.do(lambda: seen.append(world.say("M20")), stall + 3.5)
    run(world, job)
    assert "received nothing from this computer" in world.words
    assert moved_along(world, job, plan, since) < 1.0
    if stall == 2.0:
        assert seen == [("1",)]


@pytest.mark.parametrize("place", ["3.10", "3.42", "3.46", "3.49"])
def test_the_end_is_not_reached_before_its_time(place):
    """The lines that disarm the guard leave the buffer with the last move, while the robot still moves."""
    job, _ = prepared(
        "DEFAULT (deg,s)\nP0010 MOVEJ 10 0 0 0 0 0 [1.5]\nP0020 MOVEJ 20 0 0 0 0 0 [2]\n", tm=50
    )
    world = world_of(job)
    world.order(Stop(), float(place))
    ended = world.perform(perform(world.operation, job))
    assert ended.done <= float(place) + 0.06
    assert ended.done >= float(place) - 0.2


def test_an_answer_from_before_a_pause_tells_the_pace_of_then():
    """This computer pauses while the override still rises after a resume."""
    job, _ = prepared("DEFAULT (deg,s)\nP0010 MOVEJ 20 0 0 0 0 0 [3]\nP0020 MOVEJ 0 0 0 0 0 0 [1.5]\n", tm=10)
    for seed in range(0, 40, 2):
        world = world_of(job, delay=0.03, seed=seed)
        world.order(Hold(), 1.6)
        world.order(Resume(), 2.2)
        world.stall_at = [(world.now + 2.45 + 0.01 * seed, 0.6)]
        assert world.perform(perform(world.operation, job), within=30).well, seed
        assert "another client" not in world.words, seed
