"""Tests of random timetables: a compiled timetable is where it says at all times and within the limits, as an
independent reader of the text finds. One that would break a limit is refused with a stretch that works.

200 tables are drawn; YARCLANG_RANDOM_TIMETABLES=10000 in the environment draws that many.
"""

import os

import numpy as np
import pytest
from floors import Tally
from programs import compiled, robot_of

from yarclang.campaign.timetables import KINDS, drawn
from yarclang.independent.arm import Arm
from yarclang.independent.reading import read, shares

COUNT = int(os.environ.get("YARCLANG_RANDOM_TIMETABLES", "200"))
ROBOTS = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")
FLOORS = {"as it is": 0.3, "stretched": 0.15, "positions": 0.25, "velocities": 0.25, "accelerations": 0.25}
"""Least shares of all tables that must be executed as they are, or with the proposed stretch, and that must
be executed with waypoints of each kind. (Each kind is a third of the tables.)
"""

WITHIN = 1e-4
"""The usual tolerance [rad]; for sliding joints 0.1 mm."""

LATE = 1e-3
"""Longest time by which a motion may take longer than its table [s]."""


@pytest.mark.parametrize("name", ROBOTS)
def test_timetables_are_kept_at_all_times_or_refused_with_a_stretch_that_works(name):
    robot = robot_of(name)
    arm = Arm.in_folder(robot.folder)
    tally = Tally()
    for seed in range(COUNT // len(ROBOTS)):
        random = np.random.default_rng(seed)
        kind = KINDS[seed % len(KINDS)]
        table = drawn(arm, random, kind)
        stretch, well = 1.0, False
        made, found = compiled(table.text(), robot)
        refused = [one for one in found if one.is_error]
        if [one.code for one in refused] == ["Y0616"]:
            (edit,) = refused[0].fix.edits
            assert edit.text.startswith(" STRETCH ")
            stretch = float(edit.text.split()[1])
            made, found = compiled(table.text(edit.text), robot)
            refused = [one for one in found if one.is_error]
            assert not [one for one in refused if one.code == "Y0616"], (seed, refused)
            # the proposed stretch is at most 1.8 times the one that the peaks need
            assert 1.0 < stretch < 1.8 * _needed(arm, table), (seed, stretch, _needed(arm, table))
        if made is not None and not refused:
            well = True
            assert _faults(arm, table, stretch, made.text) == [], seed
        tally.count("as it is", well and stretch == 1.0)
        tally.count("stretched", well and stretch > 1.0)
        for one in KINDS:
            tally.count(one, well and one == kind)
    assert tally.below(FLOORS) == []


def _needed(arm, table):
    """Return the stretch that the peaks of the table's own path need, at least 1."""
    asked = table.asked()
    at = np.linspace(0.0, table.times[-1], 20_001)
    fast = (np.abs(asked(at, 1)).max(axis=0) / arm.velocity).max()
    motors = (np.abs(asked(at, 1) @ arm.counts.T).max(axis=0) / arm.motor_velocity).max()
    hard = (np.abs(asked(at, 2)).max(axis=0) / arm.acceleration).max()
    return max(1.0, fast, motors, np.sqrt(hard))


def _faults(arm, table, stretch, text):
    """Return the differences between an emitted text and its table."""
    found = []
    done = read(text)[1][1]
    lasts = table.times[-1] * stretch
    if not -1e-9 <= done.duration - lasts <= LATE:
        found.append(f"takes {done.duration} s, not {lasts} s")
    used = shares(arm, done)
    found += [f"{what} {share:.5f}" for what, share in used.items() if what != "jerk" and share > 1 + 1e-6]
    at = np.linspace(0.0, 1.0, 40_001)
    off = np.abs(done.spline(at * done.duration) - table.asked(stretch)(at * lasts)) * arm.si
    if off.max() > WITHIN * (1.0 + 1e-6):
        found.append(f"off by {off.max() / WITHIN:.4f} of the tolerance")
    for end in (0.0, done.duration):
        if np.abs(done.spline(end, nu=1)).max() > 1e-6:
            found.append(f"no rest at {end} s")
    return found
