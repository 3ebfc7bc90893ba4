"""Tests of the course of a loaded program: its motion along the longest branches, and the values that were
proved.
"""

import hashlib
from types import SimpleNamespace

import pytest
from coordinator.virtual import coordinating, done, run
from hypothesis import given
from hypothesis import strategies as st

from yarclang.coordinator.attached import Here
from yarclang.coordinator.course import longest_way
from yarclang.coordinator.messages import orders
from yarclang.hir import Else, EndWhen, When
from yarclang.lasting import schedule_of
from yarclang.runtime.actions import Trouble

HEAD = "ROBOT INDUSTRIAL6\nDEFAULT [2] (deg,s)\n"
PLAIN = HEAD + "P0010 MOVEJ 5 0 0 0 0 0\nP0020 MOVEJ 5 5 0 0 0 0\nP0030 MOVEJ 0 0 0 0 0 0\n"
WAYS = (
    HEAD
    + """INPUT PART M11
P0010 MOVEJ 5 0 0 0 0 0
P0020 WAIT PART ON [60]
WHEN PART ON
  P0030 MOVEJ 5 5 0 0 0 0 [1]
ELSE
  P0040 MOVEJ 5 9 0 0 0 0 [2]
  P0050 MOVEJ 5 5 0 0 0 0 [2]
END
P0060 HOLD "look"
P0070 MOVEJ 0 0 0 0 0 0
"""
)
CALLS = (
    HEAD
    + """SUB NOD
  P0010 MOVEJ 0 5 0 0 0 0
  P0020 MOVEJ 0 0 0 0 0 0
END
REPEAT I 2
  P0100 CALL NOD
END
P0200 MOVEJ 3 0 0 0 0 0
"""
)


def trial(work, **options):
    async def whole():
        async with coordinating(**options) as (world, coordinator, client):
            client.session.leave()
            here = Here(coordinator, "anna")
            await here.ask(orders.Own())
            await work(world, coordinator, here)

    run(whole())


async def course_of(here, folder, text, samples=500, **options):
    file = folder / "p.yarc"
    file.write_text(text)
    told = await here.ask(orders.Load(file=str(file), **options))
    assert told.program is not None, told.findings
    return told.program, await here.ask(orders.AskCourse(program=told.program.number, samples=samples))


def at(course, time):
    """Return the joint positions at the sample that is nearest to a time."""
    times = course.course.times
    return course.course.joints[min(range(len(times)), key=lambda one: abs(times[one] - time))]


def test_a_plain_program(tmp_path):
    async def work(world, coordinator, here):
        program, course = await course_of(here, tmp_path, PLAIN, 301)
        assert len(course.course.times) == 301
        assert course.course.times[0] == 0.0
        assert course.course.times[-1] == pytest.approx(program.duration_s, abs=1e-3)
        assert [one.title for one in course.commands] == [one.title for one in program.commands]
        assert [one.line for one in course.commands] == [3, 4, 5]
        for one in course.commands:
            assert at(course, one.ends_s) == pytest.approx(one.end, abs=0.01)
        assert course.nearest is not None
        assert course.nearest.distance_mm > 0.0
        assert 0.0 < course.peaks.velocity.share <= 1.0
        assert (course.left_out, course.unknown, course.changed) == (0, "", False)
        assert course.sha256 == hashlib.sha256(PLAIN.encode()).hexdigest()

    trial(work)


def test_the_longest_way_and_the_waits(tmp_path):
    async def work(world, coordinator, here):
        program, course = await course_of(here, tmp_path, WAYS)
        assert [one.index for one in course.commands] == ["P0010", "P0040", "P0050", "P0070"]
        assert (course.left_out, course.takes.waits) == (1, 2)
        assert course.course.times[-1] == pytest.approx(course.takes.duration_s, abs=1e-3)
        # The course has the same times as the program's list of commands, to which progress refers.
        clocks = {one.index: one.begins_s for one in program.commands}
        assert all(one.begins_s == pytest.approx(clocks[one.index], abs=1e-3) for one in course.commands)
        assert max(one[1] for one in course.course.joints) == pytest.approx(9.0, abs=0.01)

    trial(work)


@pytest.mark.parametrize("by_steps", [False, True])
def test_from_a_command_on(tmp_path, by_steps):
    async def work(world, coordinator, here):
        _, course = await course_of(here, tmp_path, PLAIN, first="P0020", by_steps=by_steps)
        assert [one.index for one in course.commands] == ["P0020", "P0030"]
        assert course.course.times[0] == pytest.approx(course.commands[0].begins_s, abs=1e-3)
        assert course.course.joints[0] == pytest.approx([5, 0, 0, 0, 0, 0], abs=1e-3)
        assert course.course.joints[-1] == pytest.approx([0] * 6, abs=1e-3)

    trial(work)


def test_from_a_command_in_a_sub(tmp_path):
    async def work(world, coordinator, here):
        program, whole = await course_of(here, tmp_path, CALLS)
        within = program.commands[3]  # the second command of the second call
        made, course = await course_of(here, tmp_path, CALLS, first=within.index)
        assert made.begins_within
        assert [one.title for one in course.commands] == [one.title for one in program.commands[3:]]
        assert [one.end for one in course.commands] == [one.end for one in whole.commands[3:]]

    trial(work)


def test_what_was_proved_is_what_runs(tmp_path):
    """If the file changes between the proof and the run, the proved text is run."""

    async def work(world, coordinator, here):
        program, before = await course_of(here, tmp_path, PLAIN)
        (tmp_path / "p.yarc").write_text(PLAIN.replace("P0030 MOVEJ 0 0", "P0030 MOVEJ 9 0"))
        course = await here.ask(orders.AskCourse(program=program.number))
        assert (before.changed, course.changed) == (False, True)
        assert course.sha256 == before.sha256
        assert (await here.ask(orders.Run(program=program.number))).well
        assert world.stands() == pytest.approx([0] * 6, abs=1e-3)
        (tmp_path / "p.yarc").unlink()
        assert (await here.ask(orders.AskCourse(program=program.number))).changed is None

    trial(work)


def test_a_controller_text(tmp_path):
    from yarclang.cli.yarcc import main

    (tmp_path / "p.yarc").write_text(PLAIN)
    with pytest.raises(SystemExit) as ended:
        main([str(tmp_path / "p.yarc"), "--out-dir", str(tmp_path)])
    assert ended.value.code in (0, None)

    async def work(world, coordinator, here):
        told = await here.ask(orders.Load(file=str(tmp_path / "p.pmc")))
        course = await here.ask(orders.AskCourse(program=told.program.number))
        assert course.takes.duration_s == pytest.approx(6.0, abs=0.01)
        assert len(course.commands) == 3 or course.unknown

    trial(work)


def test_a_program_without_motion_and_one_that_isnt_there(tmp_path):
    async def work(world, coordinator, here):
        with pytest.raises(Trouble, match="there is no program 99"):
            await here.ask(orders.AskCourse(program=99))
        text = HEAD + "OUTPUT LAMP M1 OFF\nP0010 SET LAMP ON\nP0020 STOP\n"
        _, course = await course_of(here, tmp_path, text)
        assert (course.course.times, course.commands, course.nearest, course.peaks) == ((), (), None, None)

    trial(work)


def test_the_robot_moves_while_it_is_asked(tmp_path):
    """The course is returned during a motion, because it needs nothing from the robot."""

    async def work(world, coordinator, here):
        import asyncio

        program, _ = await course_of(here, tmp_path, PLAIN)
        running = asyncio.create_task(here.ask(orders.Run(program=program.number)))
        await world.until(lambda: world.moving)
        assert (await here.ask(orders.AskCourse(program=program.number, samples=2000))).commands
        assert (await running).well
        await done(here.client, "MOVEJ 1 0 0 0 0 0 [1] (deg,s)")

    trial(work)


WAY = st.recursive(
    st.lists(st.integers(1, 9).map(float), max_size=3),
    lambda way: st.builds(
        lambda before, first, last,
            after: [*before, "when", *first, *(["else", *last] if last else []), "end", *after],
        way, way, way, way,
    ),
    max_leaves=12,
)  # fmt: skip
"""Parts of a program as `schedule_of` takes them. Times are integers, so that their sums are exact."""


@given(WAY)
def test_the_longest_ways_follow_each_other_by_the_clock(parts):
    """The motions of the longest way together take at most as long as the program. Each begins when the
    previous one has ended.
    """
    kinds = {"when": When, "else": Else, "end": EndWhen}
    steps = [object.__new__(kinds[one]) if one in kinds else one for one in parts]
    times = {number: one for number, one in enumerate(parts) if one not in kinds}
    motions = [SimpleNamespace(step=at, curve=SimpleNamespace(duration=time)) for at, time in times.items()]
    plan = SimpleNamespace(program=SimpleNamespace(steps=steps), motions=motions)
    schedule, clock = schedule_of(parts), 0.0
    for step in sorted(longest_way(plan)):
        assert schedule.clocks[step] == clock
        clock += times[step]
    assert clock == schedule.lasting.most
