"""Tests of the branches of examples 21 to 24: in each script, the machines around the robot behave
differently.
"""

import shutil
from functools import cache

import pytest
from conftest import EXAMPLES

from tests.test_examples_run import played
from yarclang.runtime.notices import Remark
from yarclang.runtime.signals import OutputSet

BINS, BATCHES, SEAMS, RECOVERY = (
    "21_good_and_bad_bins",
    "22_conveyor_batches",
    "23_touch_up_welding",
    "24_recovery_at_start",
)
LONG = 1500.0
"""Longest time of a run [s]: two WAITs of ten minutes, one after the other, end within it."""


def entry(change, **when):
    """Return an entry of a script: `entry("HELD=ON", at=2.0)`,
    `entry("BOX=OFF", output="BOX_FULL=ON", delay=1.0)`.
    """
    name, value = change.split("=")
    keys = {"input": name, "to": int(value) if value.isdecimal() else value, **when}
    lines = (
        f'{key} = "{held}"' if isinstance(held, str) else f"{key} = {held}" for key, held in keys.items()
    )
    return "\n".join(("[[inputs]]", *lines))


@pytest.fixture
def play(tmp_path):
    """Return a function that runs an example with a script of the given entries instead of its own one."""

    def play(name, *entries, **options):
        shutil.copy(EXAMPLES / f"{name}.yarc", tmp_path)
        (tmp_path / f"{name}.inputs.toml").write_text("\n\n".join(entries) + "\n")
        return Played(*played(f"{name}.yarc", folder=tmp_path, **options))

    return play


class Played:
    """The results of a run."""

    def __init__(self, world, ended, job, operator):
        self.world, self.ended, self.operator = world, ended, operator
        self.registers = dict(ended.registers)

    def values(self, variable):
        """Return the values that the program has given an output, in order."""
        told = [one for one in self.world.told if isinstance(one, OutputSet)]
        return [one.value for one in told if one.variable == variable]

    def times(self, variable, value):
        """Return when the program has given an output this value [s]."""
        told = [one for one in self.world.told if isinstance(one, OutputSet)]
        return [one.time for one in told if (one.variable, one.value) == (variable, value)]

    @property
    def said(self):
        """All texts that the operator got."""
        return "\n".join(one.text for one in self.world.told if isinstance(one, Remark))

    def holds(self, registers):
        return {name: self.registers[name] for name in registers} == registers


@cache
def own(name, **options):
    """Run an example with its own script."""
    return Played(*played(f"{name}.yarc", **options))


GRIP, LAMP, SECOND_LAMP, ARC = "M1", "M2", "M3", "M1"

# 21: bins


def bins(passed, *more):
    here = [entry("PART=ON", at=0.2), entry(f"PASSED={passed}", at=0.0)]
    return (*here, *more)


THERE = (entry("GOOD_THERE=ON", at=0.0), entry("BAD_THERE=ON", at=0.0))


def test_the_full_good_bin_is_exchanged_before_the_next_part_is_put_there():
    run = own(BINS)
    assert run.ended.well, run.ended.what
    assert any("how many parts does a bin take?" in why for why in run.operator.waits)
    assert run.values(LAMP) == [1.0, 0.0]
    assert run.values(SECOND_LAMP) == []
    assert run.values(GRIP) == [1.0, 0.0] * 4  # good, bad, good, and after the exchange of the bin, good
    (full,), (empty,) = run.times(LAMP, 1.0), run.times(LAMP, 0.0)
    assert not [one for one in run.times(GRIP, 0.0) if full < one < empty]
    assert run.holds({"GOOD": 1, "BAD": 1, "ALL_GOOD": 3})


def test_the_full_bad_bin_is_exchanged_for_itself(play):
    run = play(
        BINS,
        *bins("OFF", *THERE),
        entry("BAD_THERE=OFF", output="BAD_FULL=ON", delay=1.0),
        entry("BAD_THERE=ON", output="BAD_FULL=ON", delay=2.0),
        entry("SHIFT_ENDS=ON", output="BAD_FULL=ON", delay=2.5),
    )
    assert run.ended.well, run.ended.what
    assert (run.values(LAMP), run.values(SECOND_LAMP)) == ([], [1.0, 0.0])
    assert run.holds({"GOOD": 0, "BAD": 1, "ALL_GOOD": 0})


def test_a_full_bin_that_stays_ends_the_program_and_the_part_stays_held(play):
    run = play(BINS, *bins("ON", *THERE), within=LONG)
    assert not run.ended.well
    assert "nobody takes the full bin away" in run.ended.what
    assert run.values(GRIP) == [1.0, 0.0, 1.0, 0.0, 1.0]
    assert run.world.machine.command(GRIP, 7).items[0] == "1"
    assert run.world.machine.command(LAMP, 7).items[0] == "0"  # its safe value


def test_a_bin_that_does_not_come_back_ends_the_program(play):
    run = play(
        BINS, *bins("ON", *THERE), entry("GOOD_THERE=OFF", output="GOOD_FULL=ON", delay=1.0), within=LONG
    )
    assert not run.ended.well
    assert "no empty bin has come" in run.ended.what


@pytest.mark.parametrize(("passed", "which"), [("ON", "good"), ("OFF", "bad")])
def test_no_part_is_let_go_where_no_bin_stands(play, passed, which):
    run = play(BINS, *bins(passed, entry("SHIFT_ENDS=ON", at=1.0)), within=LONG)
    assert not run.ended.well
    assert f"the {which} bin isn't there" in run.ended.what
    assert run.values(GRIP) == [1.0]


# 22: batches

BOX_CHANGES = (
    entry("BOX=ON", at=0.0),
    entry("BOX=OFF", output="BOX_FULL=ON", delay=1.0),
    entry("BOX=ON", output="BOX_FULL=ON", delay=2.0),
)


def test_an_empty_belt_and_a_part_that_slips_are_got_over():
    run = own(BATCHES)
    assert run.ended.well, run.ended.what
    assert any("how many parts in a box?" in why for why in run.operator.waits)
    assert run.values(SECOND_LAMP) == [1.0, 0.0]  # the belt was empty once
    assert "the belt is empty after 0 boxes" in run.said
    assert run.values(GRIP) == [1.0, 0.0] * 5  # one part slipped, then two boxes got two parts each
    assert run.values(LAMP) == [1.0, 0.0] * 2
    assert run.holds({"BOXES": 2, "SLIPPED": 1, "IN_A_ROW": 0})


def test_nothing_is_put_onto_a_full_box(play):
    """The full box is never taken away, so that the program ends."""
    run = play(BATCHES, entry("BOX=ON", at=0.0), entry("PART=ON", at=0.0), entry("HELD=ON", at=0.0))
    assert not run.ended.well
    assert "nobody takes the full box away" in run.ended.what
    assert run.values(GRIP) == [1.0, 0.0] * 2
    assert run.holds({"BOXES": 1})


def test_the_next_part_waits_for_the_next_box(play):
    run = play(BATCHES, *BOX_CHANGES[:2], entry("PART=ON", at=0.0), entry("HELD=ON", at=0.0))
    assert not run.ended.well
    assert "no empty box for a minute" in run.ended.what
    assert run.values(GRIP) == [1.0, 0.0] * 2


def test_three_parts_in_a_row_that_slip_end_the_program(play):
    run = play(BATCHES, *BOX_CHANGES, entry("PART=ON", at=0.0))
    assert not run.ended.well
    assert "three parts in a row slipped" in run.ended.what
    assert run.values(GRIP) == [1.0, 0.0] * 3
    assert run.holds({"SLIPPED": 3, "BOXES": 0})


def test_the_fingers_have_time_to_open_in_the_box():
    text = (EXAMPLES / f"{BATCHES}.yarc").read_text().splitlines()
    opened = next(place for place, line in enumerate(text) if "MOVEL $(DROPS[1])" in line) + 1
    assert "SET GRIP OFF" in text[opened]
    assert "WAIT [" in text[opened + 1]


# 23: seams

JOB = entry("PIECE=1", at=0.5)
BURNS = (entry("BURNS=ON", output="ARC=ON", delay=0.3), entry("BURNS=OFF", output="ARC=OFF"))


def test_an_arc_that_does_not_burn_is_lit_anew():
    run = own(SEAMS)
    assert run.ended.well, run.ended.what
    assert run.values(ARC) == [1.0, 0.0, 1.0, 0.0, 1.0, 0.0]
    assert run.holds({"WELDED": 2, "RELIT": 1})


@pytest.mark.parametrize(
    ("piece", "wanted", "welded"),
    [(1, (), 0), (1, (1,), 1), (1, (2,), 1), (1, (1, 2), 2), (2, (1, 2), 1), (2, (2,), 0)],
)
def test_the_seams_that_are_wanted_are_welded(play, piece, wanted, welded):
    seams = (entry(f"SEAM_{one}=ON", at=0.0) for one in wanted)
    run = play(SEAMS, entry(f"PIECE={piece}", at=0.5), *BURNS, *seams)
    assert run.ended.well, run.ended.what
    assert run.values(ARC) == [1.0, 0.0] * welded
    assert run.holds({"WELDED": welded, "RELIT": 0})


def test_three_tries_are_the_last(play):
    run = play(SEAMS, JOB, entry("SEAM_1=ON", at=0.0))
    assert not run.ended.well
    assert "the arc doesn't burn after three tries" in run.ended.what
    assert run.values(ARC) == [1.0, 0.0] * 3


def test_nothing_is_welded_without_an_arc(play):
    """The source reports the arc only after it was switched off, so that the program strikes it once more."""
    run = play(SEAMS, JOB, entry("SEAM_1=ON", at=0.0), entry("BURNS=ON", output="ARC=OFF", delay=0.1))
    assert run.ended.well, run.ended.what
    assert run.values(ARC) == [1.0, 0.0, 1.0, 0.0]
    assert run.holds({"WELDED": 1, "RELIT": 1})


def test_a_workpiece_whose_seams_nobody_knows_ends_the_program(play):
    run = play(SEAMS, entry("PIECE=3", at=0.5), *BURNS)
    assert not run.ended.well
    assert "no seams are known of this workpiece" in run.ended.what
    assert run.values(ARC) == []


# 24: recovery

MACHINE = (
    entry("HELD=ON", output="GRIP=ON", delay=0.1),
    entry("HELD=OFF", output="GRIP=OFF", delay=0.1),
    entry("MACHINE_EMPTY=OFF", place="P0200"),
    entry("MACHINE_EMPTY=ON", place="P0220", delay=1.0),
)
"""A gripper that reports whether it holds a part, and a machine that takes one second for each part."""
HELD_STILL = {"M1": 1}
"""The run before left the gripper closed."""


def test_three_parts_are_made_where_nothing_was_left():
    run = own(RECOVERY)
    assert run.ended.well, run.ended.what
    assert run.operator.waits == [] or all("waits for" in why for why in run.operator.waits)
    assert run.values(GRIP) == [0.0] + [1.0, 0.0] * 3
    assert run.values(LAMP) == []
    assert run.world.kept == {"PHASE": 0, "DONE": 0}
    assert "three parts are done, 0 were lost" in run.said


@pytest.mark.parametrize("phase", [0, 1, 2])
def test_a_part_between_the_fingers_goes_to_the_chute(play, phase):
    """The part goes to the chute whatever the registers say, because the stop may have come between an action
    and its record.
    """
    before = (entry("MACHINE_EMPTY=ON", at=0.0), entry("HELD=ON", at=0.0))
    run = play(RECOVERY, *before, *MACHINE, held={"PHASE": phase, "DONE": 2, "LOST": 4}, outputs=HELD_STILL)
    assert run.ended.well, run.ended.what
    assert "it goes to the chute" in run.said
    assert run.values(GRIP) == [0.0, 1.0, 0.0]  # opens over the chute, then handles the third part
    assert run.values(LAMP) == []
    assert run.holds({"PHASE": 0, "DONE": 0, "LOST": 5})
    assert run.world.kept == {"PHASE": 0, "DONE": 0, "LOST": 5}


def test_a_part_that_stays_between_the_fingers_ends_the_program_over_the_chute(play):
    run = play(
        RECOVERY, entry("MACHINE_EMPTY=ON", at=0.0), entry("HELD=ON", at=0.0), held={"PHASE": 1, "DONE": 2}
    )
    assert not run.ended.well
    assert "the part doesn't leave the fingers" in run.ended.what
    assert run.holds({"PHASE": 1, "DONE": 2, "LOST": 0})


@pytest.mark.parametrize("phase", [1, 2])
@pytest.mark.parametrize("taken", ["MACHINE_EMPTY", "CLEARED"])
def test_a_part_in_the_machine_is_taken_out_by_the_operator(play, phase, taken):
    """In phase 1, the run was stopped when the part was in the machine already."""
    after = () if taken == "MACHINE_EMPTY" else (entry("MACHINE_EMPTY=ON", at=20.0),)
    run = play(RECOVERY, entry(f"{taken}=ON", at=3.0), *after, *MACHINE, held={"PHASE": phase, "DONE": 1})
    assert run.ended.well, run.ended.what
    assert any("a part lies in the machine" in why for why in run.operator.waits)
    assert run.values(LAMP) == [1.0, 0.0]
    assert run.values(GRIP) == [0.0] + [1.0, 0.0] * 2
    assert run.holds({"PHASE": 0, "DONE": 0, "LOST": 1})


def test_a_part_that_nobody_takes_out_of_the_machine_ends_the_program(play):
    run = play(RECOVERY, *MACHINE, held={"PHASE": 2, "DONE": 1})
    assert not run.ended.well
    assert "the part is still in the machine" in run.ended.what
    assert run.holds({"PHASE": 2, "DONE": 1, "LOST": 0})
    assert 1.0 not in run.values(GRIP)


STOPS = (2.0, 3.5, 4.5, 5.3, 5.6, 6.2, 6.8, 7.2, 7.6, 8.0, 8.4, 9.0)
"""Times of stops during the first cycle and the beginning of the second one [s]."""


@pytest.mark.parametrize("stop", STOPS)
def test_a_run_goes_on_after_a_stop_at_any_time(play, stop):
    """The second run continues with the registers of the first one, and with the parts that it left in the
    gripper and in the machine.
    """
    first = own(RECOVERY, stop=stop)
    assert not first.ended.well
    kept = first.world.kept
    held, there = (first.world.machine.command(one, 7).items[0] for one in ("M70", "M71"))
    shut = first.world.machine.command(GRIP, 7).items[0]
    assert held == shut
    left = [
        entry(f"{name}=ON", at=0.0)
        for name, is_on in (("HELD", held), ("MACHINE_EMPTY", there))
        if is_on == "1"
    ]
    taken = [] if there == "1" else [entry("CLEARED=ON", at=3.0), entry("MACHINE_EMPTY=ON", at=10.0)]
    second = play(RECOVERY, *left, *taken, *MACHINE, held=kept, outputs={GRIP: int(shut)})
    assert second.ended.well, second.ended.what
    assert second.values(GRIP) == [0.0] + [1.0, 0.0] * (3 - kept.get("DONE", 0))
    assert second.holds({"PHASE": 0, "DONE": 0, "LOST": int(held) + (there == "0")})


def test_these_stops_leave_all_that_can_be_left():
    """Together, the stops leave all possible states: no part, a part in the gripper, a part in the machine,
    recorded or not, and a counted part.
    """
    found = set()
    for stop in STOPS:
        first = own(RECOVERY, stop=stop)
        held, there = (first.world.machine.command(one, 7).items[0] == "1" for one in ("M70", "M71"))
        found.add((held, there, first.registers["PHASE"], first.registers["DONE"]))
    assert {(False, True, 1, 0), (True, True, 1, 0), (False, False, 1, 0), (False, False, 2, 0)} <= found
    assert any(done for *_, done in found)
