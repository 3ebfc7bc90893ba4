"""Motions of every mode follow their rule, as recorded at any instant."""

import numpy as np
import pytest
from simulator.machines import bare, error, program, rotary, say


def trace(machine, *times):
    return machine.positions(np.array(times))


def test_spline1(conformance):
    """The position at any instant agrees with the conformance file to 1e-9."""
    data = conformance("spline1")
    machine = bare("1000X", "1000Y")
    program(machine, f"LINEAR TA1 TS0 TM1 X{data['start'][0]}Y{data['start'][1]} DWELL0")
    say(machine, "B1R")
    machine.advance(10)
    rows = [f"X{x}Y{y}" for x, y in data["points"]]
    program(machine, "SPLINE1 TM50", *rows)
    say(machine, "B1R")
    begin = machine.now
    machine.advance(1)
    times = np.array(data["t"])
    got = machine.positions(begin + times) / 1000
    assert np.abs(got - np.array(data["x"])).max() < 1e-9
    velocity = machine.record.velocities(1, begin + times) / 1000
    assert np.abs(velocity - np.array(data["v"])[:, 0]).max() < 2e-8


def test_n_moves_take_n_and_two_segments():
    machine = bare("1000X")
    program(machine, "SPLINE1 TM100", *["X1"] * 3)
    say(machine, "B1R")
    machine.advance(0.499)
    assert int(say(machine, "??")[0][:6], 16) & 1
    machine.advance(0.002)
    assert not int(say(machine, "??")[0][:6], 16) & 1
    assert say(machine, "P") == ("1000",)


def test_segment_time_is_kept_in_4096ths_and_clipped():
    machine = bare("1X")
    program(machine, "SPLINE1 TM5.0001", "X1", "X2", "TM9999", "X3")
    say(machine, "B1R")
    machine.advance(30)
    system = machine.systems[1]
    assert not system.busy
    ends = [time for time in machine.record._times[1] if time > 0]
    assert ends[0] == pytest.approx(round(5.0001 * 4096) / 4096e3, abs=1e-12)
    # 4 segments with the first time, and 3 with the longest
    assert ends[-1] == pytest.approx(4 * round(5.0001 * 4096) / 4096e3 + 3 * (4.096 - 1e-3 / 4096), abs=1e-9)


def test_i42_takes_ta():
    machine = bare("1X")
    program(machine, "SPLINE1 TA20.4 TM500", "X1")
    say(machine, "I42=1", "B1R")
    machine.advance(0.061)
    assert not machine.systems[1].busy


def test_other_segment_time_ends_the_sequence():
    machine = bare("1000X")
    program(machine, "SPLINE1 TM50", "X1", "X2", "TM100", "X3")
    say(machine, "B1R")
    machine.advance(1)
    # motor 1 rests at X2 after (2 + 2) 50 ms
    assert trace(machine, 0.2)[0, 0] == pytest.approx(2000)
    assert machine.record.velocities(1, np.array([0.2]))[0] == pytest.approx(0, abs=1e-6)
    assert trace(machine, 0.5)[0, 0] == pytest.approx(3000)


def test_lone_linear_move_takes_tm_and_ta():
    machine = bare("1000X")
    say(machine, "I116=1000", "I117=100")
    program(machine, "LINEAR TA100 TS0 TM400", "X10")
    say(machine, "B1R")
    machine.advance(1)
    # 25 counts/ms after 100 ms
    assert trace(machine, 0.05, 0.1, 0.25, 0.4, 0.5)[:, 0] == pytest.approx([312.5, 1250, 5000, 8750, 10000])
    assert trace(machine, 0.4999)[0, 0] < 10000


def test_linear_moves_blend_around_the_corner():
    machine = bare("1000X", "1000Y")
    say(machine, "I116=1000", "I216=1000", "I117=100", "I217=100")
    program(machine, "LINEAR TA100 TS0 TM400", "X10", "Y10")
    say(machine, "B1R")
    machine.advance(2)
    at = trace(machine, 0.4, 0.45, 0.5, 0.9)
    # the corner is cut off by V TA / 8
    assert at[1] == pytest.approx([10000 - 25 * 100 / 8, 25 * 100 / 8])
    assert at[0] == pytest.approx([8750, 0])
    assert at[2] == pytest.approx([10000, 1250])
    assert at[3] == pytest.approx([10000, 10000])


def test_linear_by_feedrate():
    machine = bare("1000X", "1000Y")
    say(machine, "I116=1000", "I216=1000", "I117=100", "I217=100")
    program(machine, "LINEAR TA100 TS0 F10", "X3Y4")
    say(machine, "B1R")
    machine.advance(0.599)
    assert machine.systems[1].busy
    machine.advance(0.002)
    assert not machine.systems[1].busy
    assert machine.positions() == pytest.approx([3000, 4000])


def test_linear_is_slowed_by_ixx16_and_ixx17():
    machine = bare("1000X")
    say(machine, "I116=10", "I117=0.01")
    program(machine, "LINEAR TA10 TS0 TM1", "X10")
    say(machine, "B1R")
    machine.advance(10)
    times = np.linspace(0, 3, 3001)
    velocity = machine.record.velocities(1, times)
    assert velocity.max() == pytest.approx(10e3)
    assert np.diff(velocity).max() / 1e-3 == pytest.approx(0.01e6, rel=1e-3)


def test_s_curve_is_continuous_in_acceleration():
    machine = bare("1000X")
    say(machine, "I116=1000", "I117=100")
    program(machine, "LINEAR TA100 TS50 TM400", "X10")
    say(machine, "B1R")
    machine.advance(1)
    times = np.linspace(0, 0.5, 5001)
    acceleration = np.diff(machine.record.velocities(1, times)) / 1e-4
    assert np.abs(np.diff(acceleration)).max() < 2500
    assert acceleration.max() == pytest.approx(2 * 25e3 / 0.1, rel=0.01)


def test_rapid_each_motor_by_itself():
    machine = bare("1000X", "1000Y")
    say(machine, "I190=0 I290=0 I122=10 I222=20 I119=0.1 I219=0.1 I120=0I121=0I220=0I221=0")
    program(machine, "RAPID X10Y10")
    say(machine, "B1R")
    machine.advance(3)
    times = np.linspace(0, 2, 2001)
    fast = [np.abs(machine.record.velocities(n, times)).max() for n in (1, 2)]
    assert fast == pytest.approx([10e3, 20e3])
    # distance / v + v / a
    assert trace(machine, 1.1, 0.7)[[0, 1], [0, 1]] == pytest.approx([10000, 10000])
    assert trace(machine, 0.65)[0, 1] < 9999


def test_rapid_takes_ixx16_where_ixx90_is_1():
    machine = bare("1000X")
    say(machine, "I190=1 I116=5 I122=10")
    program(machine, "RAPID X10")
    say(machine, "B1R")
    machine.advance(5)
    assert machine.record.velocities(1, np.linspace(0, 4, 4001)).max() == pytest.approx(5e3)


def test_pvt_passes_through_its_points():
    machine = bare("1000X")
    program(machine, "PVT100", "X1:15", "X2:0")
    say(machine, "B1R")
    machine.advance(1)
    assert trace(machine, 0.1, 0.2)[:, 0] == pytest.approx([1000, 2000])
    assert machine.record.velocities(1, np.array([0.1, 0.2])) == pytest.approx([15000, 0], abs=1e-6)


def test_pvt_time_from_tm():
    machine = bare("1000X")
    program(machine, "PVT100", "X1:0", "PVT(50)", "X2:0")
    say(machine, "B1R")
    machine.advance(0.151)
    assert not machine.systems[1].busy


def test_dwell_is_not_scaled_and_delay_is():
    for word, time in (("DWELL", 0.2), ("DELAY", 0.4)):
        machine = bare("1000X")
        say(machine, "I5194=1000000")
        program(machine, f"{word}200 P1=1")
        say(machine, "%50", "B1R")
        machine.advance(time - 0.01)
        assert machine.systems[1].busy
        machine.advance(0.02)
        assert not machine.systems[1].busy


def test_incremental_and_pset():
    machine = bare("1000X", "1000Y")
    program(machine, "INC(X)", "LINEAR TA10 TM50", "X1Y1", "X1Y1", "PSET Y5", "Y6", "ABS")
    say(machine, "B1R")
    machine.advance(2)
    assert machine.positions() == pytest.approx([2000, 2000])


def test_coupled_axes_and_pmatch():
    machine = bare("10X", "10Y+10Z", "10Z+50")
    program(machine, "RAPID X1Y2Z3")
    say(machine, "B1R")
    machine.advance(5)
    assert machine.positions() == pytest.approx([10, 50, 80])
    say(machine, "#2J=100")
    machine.advance(5)
    program(machine, "INC", "RAPID X1")
    say(machine, "B1R")
    machine.advance(5)
    assert machine.positions() == pytest.approx([20, 100, 80])


def test_override_scales_time():
    machine = bare("1000X")
    say(machine, "I5194=100000000")
    program(machine, "SPLINE1 TM100", "X1", "X2")
    say(machine, "%50", "B1R")
    machine.advance(0.79)
    assert machine.systems[1].busy
    machine.advance(0.02)
    assert not machine.systems[1].busy
    assert say(machine, "%") == ("50",)


def test_hold_stays_on_the_path_and_resumes():
    machine = bare("1000X", "1000Y")
    rows = [f"X{i * 0.1:.3f}Y{i * i * 0.01:.3f}" for i in range(1, 40)]
    program(machine, "SPLINE1 TM50", *rows)
    say(machine, "B1R")
    machine.advance(3)
    whole = machine.positions(np.linspace(0, 2.05, 2051))
    other = bare("1000X", "1000Y")
    program(other, "SPLINE1 TM50", *rows)
    say(other, "B1R")
    other.advance(1.0)
    say(other, "H")
    other.advance(2)
    held = other.positions()
    # I5195 = 1644: the pace decreases from 100 % in 1 s, which is half a second of the program
    assert held == pytest.approx(machine.positions(np.array([1.5]))[0], abs=1)
    assert other.positions() == pytest.approx(held)
    assert error(other, "R") is None
    other.advance(5)
    assert other.positions() == pytest.approx(whole[-1])
    path = other.positions(np.linspace(0, 7, 701))
    assert np.abs(path[:, 1] / 1000 - (path[:, 0] / 1000) ** 2).max() < 0.02


def test_resume_is_refused_with_motors_moved_away():
    machine = bare("1000X")
    program(machine, "SPLINE1 TM50", *[f"X{i}" for i in range(1, 60)])
    say(machine, "B1R")
    machine.advance(1)
    say(machine, "H")
    machine.advance(1.5)
    before = machine.positions()[0]
    say(machine, "#1J^500")
    machine.advance(2)
    assert error(machine, "R") == 17
    say(machine, f"J={before}")
    assert error(machine, "R") == 11
    machine.advance(2)
    say(machine, "R")
    machine.advance(10)
    assert machine.positions()[0] == pytest.approx(59000)


def test_abort_decelerates_each_motor_at_ixx15():
    machine = bare("1000X", "1000Y")
    say(machine, "I115=0.5 I215=0.1")
    program(machine, "SPLINE1 TM50", *[f"X{i}Y{i}" for i in range(1, 60)])
    say(machine, "B1R")
    machine.advance(1)
    speed = [machine.motors[n].place(machine.now)[1] for n in (1, 2)]
    assert speed == pytest.approx([20e3, 20e3], rel=1e-6)
    place = machine.positions()
    say(machine, "A")
    assert not machine.systems[1].busy
    assert int(say(machine, "#1?")[0][:6], 16) >> 12 & 1
    machine.advance(0.0401)
    # 20 counts/ms at 0.5: 40 ms and 400 counts; at 0.1: 200 ms and 2000 counts
    assert machine.motors[1].place(machine.now)[1] == 0
    assert machine.motors[2].place(machine.now)[1] > 0
    machine.advance(1)
    assert machine.positions() - place == pytest.approx([400, 2000])


def test_quit_moves_what_is_calculated_and_slash_does_not():
    ends = {}
    for order in ("Q", "/"):
        machine = bare("1000X")
        program(machine, "LINEAR TA10TS0 TM200", *[f"X{i}" for i in range(1, 10)])
        say(machine, "I116=1000I117=100", "B1R")
        machine.advance(0.5)
        say(machine, order)
        machine.advance(5)
        assert not machine.systems[1].busy
        ends[order] = machine.positions()[0]
        say(machine, "R")
        machine.advance(5)
        assert machine.positions()[0] == pytest.approx(9000)
    assert ends == {"Q": pytest.approx(5000), "/": pytest.approx(4000)}


def test_single_step():
    machine = bare("1000X")
    program(machine, "LINEAR TA10TS0 TM100", "X1", "X2", "X3")
    for place in (1000, 2000, 3000):
        say(machine, "B1S" if place == 1000 else "S")
        machine.advance(2)
        assert machine.positions()[0] == pytest.approx(place)
        assert not machine.systems[1].running


@pytest.mark.parametrize(
    ("pause", "go_on"),
    [("H", "R"), ("%0", "%100"), ("%50", "%100")],
    ids=["hold", "override 0", "override 50"],
)
@pytest.mark.parametrize(
    "move", ["RAPID X100", "LINEAR TA20 TS0 TM5000 X100", "SPLINE1 TM2000|X50|X100|X150"]
)
def test_a_limit_stops_behind_a_pause(move, pause, go_on):
    machine = bare("1000X")
    say(machine, "I113=50000 I115=2 I116=30")
    program(machine, *move.split("|"))
    say(machine, "B1R")
    machine.advance(0.7)
    say(machine, pause)
    machine.advance(0.5)
    say(machine, go_on)
    machine.advance(10)
    assert machine.systems[1].limit_stop
    assert 50000 <= machine.positions()[0] < 51000


@pytest.mark.parametrize("start", ["B1R", "#1J+", "#1J=100000"])
def test_a_limit_counts_from_when_it_is_set(start):
    machine = bare("1000X")
    say(machine, "I115=2 I116=30 I122=30")
    program(machine, "LINEAR TA20 TS0 TM5000 X100")
    say(machine, start)
    machine.advance(0.7)
    say(machine, "I113=50000")
    machine.advance(10)
    assert 50000 <= machine.positions()[0] < 51000
    say(machine, "I113=0", "#1J=0")
    machine.advance(10)
    say(machine, start)
    machine.advance(0.7)
    say(machine, "I113=50000", "I113=60000")
    machine.advance(10)
    assert 60000 <= machine.positions()[0] < 61000


@pytest.mark.parametrize("held", [False, True])
def test_axes_may_be_defined_between_programs(held):
    machine = bare("1000X", "1000Y")
    program(machine, "X1Y1")
    say(machine, "I300=1", "#3J/", "B1R")
    machine.advance(5)
    if held:
        say(machine, "H")
        machine.advance(5)
    say(machine, "#3->10Z", "B1")
    program(machine, "X2Y3Z4")
    say(machine, "B1R")
    machine.advance(5)
    assert list(machine.positions()) == [2000, 3000, 40]


def test_a_jog_in_a_hold_is_not_cut_off():
    """After a hold in a pause, the next move begins only after R."""
    machine = bare("1000X")
    say(machine, "I122=10 I119=1 I120=0 I121=0 I5195=100000")
    program(machine, "LINEAR TA10TS0 TM100", "X1", "DWELL1000", "X5")
    say(machine, "B1R")
    machine.advance(0.5)
    say(machine, "H")
    machine.advance(0.1)
    say(machine, "J+")
    machine.advance(3)
    assert machine.motors[1].place(machine.now)[1] == 10e3
    say(machine, "J/")
    machine.advance(1)
    assert error(machine, "R") == 17
    say(machine, "J=")
    machine.advance(10)
    assert machine.positions()[0] == 1000
    say(machine, "R")
    machine.advance(5)
    assert machine.positions()[0] == 5000


def test_jogs():
    machine = bare("X")
    say(machine, "I122=10 I119=0.1 I120=0 I121=0")
    say(machine, "#1J+")
    machine.advance(1)
    assert machine.positions()[0] == pytest.approx(10e3 - 10e3 * 0.05)
    say(machine, "J-")
    machine.advance(1)
    assert machine.motors[1].place(machine.now)[1] == -10e3
    say(machine, "J/")
    machine.advance(1)
    assert not machine.motors[1].jogging
    say(machine, "J=5000")
    machine.advance(5)
    assert machine.positions()[0] == 5000
    say(machine, "J:-100")
    machine.advance(5)
    assert say(machine, "P") == ("4900",)


def test_home():
    machine = bare("X")
    say(machine, "J=5000")
    machine.advance(2)
    say(machine, "HM")
    assert int(say(machine, "?")[0][:6], 16) >> 10 & 1
    machine.advance(2)
    word = int(say(machine, "?")[0][6:], 16)
    assert (machine.positions()[0], word >> 10 & 1) == (0, 1)
    say(machine, "J=300")
    machine.advance(2)
    say(machine, "HMZ")
    assert machine.positions()[0] == 0


def test_running_dry_is_no_error():
    machine = bare("1000X")
    rotary(machine, "SPLINE1 TM100", "X1", "X2", "X3")
    say(machine, "R")
    machine.advance(2)
    assert machine.positions()[0] == pytest.approx(3000)
    word = int(say(machine, "??")[0][:6], 16)
    assert word & 1
    assert say(machine, "PR") == ("0",)
    begin = machine.now
    say(machine, "OPEN ROT", "X4", "CLOSE")
    machine.advance(2)
    assert machine.positions(np.array([begin + 0.29]))[0, 0] < 4000
    assert machine.positions(np.array([begin + 0.3]))[0, 0] == pytest.approx(4000)


@pytest.mark.parametrize(("at", "late"), [(0.25, False), (0.35, True)])
def test_how_late_a_line_may_come(at, late):
    """After X1 X2 X3, the end piece of the spline begins 0.3 s after the start. A further line must come
    before this time.
    """
    machine = bare("1000X")
    rotary(machine, "SPLINE1 TM100", "X1", "X2", "X3")
    say(machine, "R")
    machine.advance(at)
    say(machine, "OPEN ROT", "X4", "CLOSE")
    machine.advance(3)
    stopped = machine.record.velocities(1, np.array([0.5]))[0] == pytest.approx(0, abs=1e-6)
    assert stopped == late
    assert machine.positions(np.array([0.6]))[0, 0] == (
        pytest.approx(4000) if not late else pytest.approx(3000 + 1000 / 6)
    )


def test_synchronous_assignment():
    """A synchronous assignment is executed where its move begins, not when it is calculated.

    An assignment after the last move isn't executed at all.
    """
    machine = bare("1000X")
    program(machine, "SPLINE1 TM100", "X1", "M1==1", "X2", "X3", "M2==1")
    say(machine, "M1->*", "M2->*", "B1R")
    machine.advance(0.19)
    assert say(machine, "M1") == ("0",)
    machine.advance(0.02)
    assert say(machine, "M1") == ("1",)
    machine.advance(3)
    assert say(machine, "M2") == ("0",)
    program(machine, "SPLINE1 TM100", "X1", "M2==1", "DWELL10")
    say(machine, "B1R")
    machine.advance(3)
    assert say(machine, "M2") == ("1",)


def test_too_short_segment_is_a_run_time_error():
    machine = bare("1000X")
    program(machine, "SPLINE1 TM1", "X1", "X2")
    say(machine, "B1R")
    machine.advance(1)
    assert int(say(machine, "??")[0][6:12], 16) >> 22 & 1
