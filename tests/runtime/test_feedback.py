"""Tests of reports of positions and status words, including reports that no controller sends."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from simulator.machines import robot_machine

from yarclang.pmac.status import MOTOR_WORD_1, MOTOR_WORD_2
from yarclang.runtime.pmac.feedback import (
    MotorStatus,
    ReportError,
    counts_in,
    groups_of,
    in_order,
    motor_status,
    statuses_in,
    system_status,
)
from yarclang.runtime.sample import Sample


def status(*names):
    first = sum(1 << MOTOR_WORD_1[name] for name in names if name in MOTOR_WORD_1)
    second = sum(1 << MOTOR_WORD_2[name] for name in names if name in MOTOR_WORD_2)
    return MotorStatus(first, second)


def test_groups_of_eight():
    assert groups_of((1, 6)) == (1,)
    assert groups_of((8, 9, 17, 32)) == (1, 9, 17, 25)


def test_counts_of_a_group():
    assert counts_in("1 -2.5 +3 4 5 6 7 8", 1, (2, 9)) == {2: -2.5}
    assert counts_in("1 -2.5 3", 9, (2, 9, 11)) == {9: 1.0, 11: 3.0}
    assert list(in_order({9: 1.0, 2: 5.0}, (2, 9))) == [5.0, 1.0]


@pytest.mark.parametrize("text", ["", "1", "1 x", "1 nan", "1 1_0", "1 1e5", "1 2-", "1 0x1"])
def test_what_is_not_a_list_of_counts(text):
    with pytest.raises(ReportError):
        counts_in(text, 1, (1, 2))


@pytest.mark.parametrize(
    "text",
    ["", "88200001840", "8820000184011", "88200001840G", "8_2000018401", "0x2000018401", "+82000018401"],
)
def test_what_is_not_a_status(text):
    with pytest.raises(ReportError):
        motor_status(text)
    with pytest.raises(ReportError):
        system_status(text)
    with pytest.raises(ReportError):
        statuses_in(text, 1, (1,))


@given(st.text("0123456789ABCDEF", min_size=12, max_size=12))
def test_status_words_are_their_digits(text):
    found = motor_status(text)
    assert f"{found.first:06X}{found.second:06X}" == text


@given(st.text(max_size=40))
def test_no_text_does_anything_but_a_report_error(text):
    for read in (
        motor_status,
        system_status,
        lambda t: counts_in(t, 1, (1, 3)),
        lambda t: statuses_in(t, 1, (1,)),
    ):
        try:
            read(text)
        except ReportError:
            continue


def test_what_keeps_a_motor_from_moving():
    well = ("activated", "amplifier enabled", "desired velocity zero", "home complete")
    assert status(*well).trouble == ""
    assert "amplifier" in status(*well, "amplifier fault", "open loop").trouble
    assert "Ixx11" in status(*well, "fatal following error", "open loop").trouble
    assert "positive limit" in status(*well, "stopped on limit", "positive limit set").trouble
    assert "negative limit" in status(*well, "stopped on limit", "negative limit set").trouble
    assert "a limit" in status(*well, "stopped on limit").trouble
    assert "open-loop" in status(*well, "open loop").trouble
    assert "Ixx00" in status("desired velocity zero").trouble


def test_when_a_motor_is_at_rest():
    assert status("activated", "desired velocity zero").at_rest
    assert status("activated", "open loop").at_rest
    assert not status("activated").at_rest
    assert not status("desired velocity zero", "abort deceleration").at_rest
    assert not status("desired velocity zero", "home search in progress").at_rest


def test_a_real_machine_is_read(industrial6):
    _, machine = robot_machine("INDUSTRIAL6")
    motors = industrial6.controller.motors
    words = statuses_in(machine.control(2).items[0], 1, motors)
    assert all(words[motor].at_rest and not words[motor].trouble for motor in motors)
    assert not system_status(machine.command("&1??").items[0]).running
    actual = in_order(counts_in(machine.control(16).items[0], 1, motors), motors)
    sample = Sample(0.0, 0.0, actual, actual * 0.0)
    assert sample.joints(industrial6) == pytest.approx(industrial6.home)
    assert sample.commanded == pytest.approx(actual)
