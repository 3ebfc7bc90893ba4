"""Tests of the judge of the controller's settings: the settings that yarc prints are proved for all robots,
and each change of them gives one clear finding.
"""

import re
from dataclasses import replace

import numpy as np
import pytest
from conftest import EXAMPLES
from hypothesis import given, settings
from hypothesis import strategies as st
from robot.made_arms import DATA, REAL, made

from yarclang.backend_pmac import settings as writer
from yarclang.backend_pmac.settings import settings_text
from yarclang.certify.pmac.settings import certify_settings
from yarclang.certify.pmac.settings.expression import NotAffineError, evaluate, variable
from yarclang.robot.actuation import from_counts, joints_per_count, to_counts
from yarclang.robot.description import load_robot
from yarclang.robot.library import list_robots
from yarclang.source import SourceFile


def judged(text, robot):
    return certify_settings(SourceFile("settings.txt", text), robot)


def the_findings(text, robot):
    """Return the errors. Check that each refers to a line of the text."""
    found = judged(text, robot)
    assert found.value is None
    for finding in found.diagnostics:
        assert finding.is_error
        assert finding.help
        assert 1 <= finding.span.line <= text.count("\n") + 1
        assert len(finding.message) < 300
    return found.diagnostics


def the_finding(text, robot):
    """Return the only error."""
    (finding,) = the_findings(text, robot)
    return finding


def coupled():
    """Return INDUSTRIAL6 with other motors, two couplings, offsets, a reversed gear, and another coordinate
    system.
    """
    robot = load_robot("INDUSTRIAL6").value
    coupling = np.eye(6)
    coupling[:3, :3] = [[1, 0.25, 0], [0.5, 1, -0.125], [0, 1, 2]]
    coupling[4:, 4:] = [[1, 1], [1, -1]]
    actuation = replace(
        robot.actuation,
        gear=np.array([25532.8278, -25667.875, 29308.7083, 7110.1274, 13285.5409, -11104.5417]),
        coupling=coupling,
        offset=np.array([0.0, 1234.5, -98765.4321, 0.0, -20.25, 1e6]),
    )
    controller = replace(
        robot.controller,
        axes=("X", "Y", "Z", "A", "U", "V"),
        motors=(7, 3, 1, 12, 2, 32),
        feedback=("P10", "P11", "P5", "P0", "P8099", "P200"),
        coordinate_system=3,
        ixx08=32,
        hold_time=0.4,
    )
    return replace(robot, actuation=actuation, controller=controller, written=None)


ROBOTS = {one.name: load_robot(one.name).value for one in list_robots()} | {"coupled": coupled()}
TEXTS = {name: settings_text(robot) for name, robot in ROBOTS.items()}


@pytest.fixture(params=ROBOTS)
def name(request):
    return request.param


# the settings that yarc writes are proved


def test_all_robots_are_proved(name):
    found = judged(TEXTS[name], ROBOTS[name])
    assert found.diagnostics == ()
    assert found.value.text == TEXTS[name]
    assert found.value.commanded.max() < 1e-9
    assert found.value.feedback.max() < 1e-9


def test_registers_are_those_of_the_manual():
    """Addresses agree with the manual (TSRM 281-287): those of motors differ by $80, those of coordinate
    systems by $100.
    """
    pointers = judged(TEXTS["coupled"], ROBOTS["coupled"]).value.content.pointers
    told = {one.variable: one.address for one in pointers}
    assert (told["M161"], told["M162"]) == ("D:$000088", "D:$00008B")
    assert (told["M761"], told["M762"]) == ("D:$000388", "D:$00038B")
    assert (told["M3261"], told["M3262"]) == ("D:$001008", "D:$00100B")
    assert told["M8116"] == "Y:$00223F,16,1"


@pytest.mark.parametrize("arm", ["ur5", "tiago-8", "double-pendulum-continuous"])
def test_new_robots_are_proved(arm, tmp_path):
    urdf, arguments, _ = REAL[arm]
    robot = made(DATA / urdf, tmp_path / "arm", *arguments)
    assert judged(settings_text(robot), robot).diagnostics == ()


def test_sliding_joints_are_proved_in_mm(tmp_path):
    robot = made(EXAMPLES / "scara.urdf", tmp_path / "arm", "--counts", "8000")
    proved = judged(settings_text(robot), robot)
    assert proved.diagnostics == ()
    wrong = changed(r"^(P3=.*/\d+)\.\d", r"\1.9")(settings_text(robot))
    assert re.search(r"P3 differs from J3 by up to [\d.]+ mm", the_finding(wrong, robot).message)


def lines_of(text):
    return text.splitlines(keepends=True)


def test_comments_and_empty_lines_may_be_added(name):
    edited = TEXTS[name].replace("CLOSE ALL\n", "\n; loaded by me\nCLOSE ALL\n   \n")
    edited = edited.replace("P8100=0\n", "P8100=0  ; not armed\n").replace(" ; position scale", "")
    assert judged(edited, ROBOTS[name]).diagnostics == ()


numbers = st.floats(0.1, 10.0).flatmap(lambda size: st.sampled_from([size, -size]))


@st.composite
def robots(draw):
    """INDUSTRIAL6 with random drives: gears, couplings of XYZ and UVW, offsets, limits, motors, coordinate
    system.
    """
    robot = ROBOTS["INDUSTRIAL6"]
    axes = draw(st.sampled_from([("X", "Y", "Z", "A", "B", "C"), ("A", "U", "V", "W", "X", "Y")]))
    coupling = np.eye(6)
    for group in ("XYZ", "UVW"):
        at = [row for row, axis in enumerate(axes) if axis in group]
        entries = st.lists(
            st.sampled_from([0.0, 1.0, -1.0, 0.5, -0.3]) | st.floats(-2.0, 2.0), min_size=9, max_size=9
        )
        block = np.array(draw(entries)).reshape(3, 3)[: len(at), : len(at)]
        block[np.abs(block) < 1e-3] = 0.0
        if len(at) > 1 and np.linalg.cond(block) < 1e3:
            coupling[np.ix_(at, at)] = block
    each = lambda values: np.array(draw(st.lists(values, min_size=6, max_size=6)))  # noqa: E731
    gear = each(st.sampled_from([-1.0, 1.0])) * each(
        st.sampled_from([25532.8278, 1e5 / 3, 8000 / 360]) | st.floats(0.01, 1e5)
    )
    offset = each(st.just(0.0) | st.integers(-100000, 100000).map(float) | st.floats(-1e6, 1e6))
    half = each(st.floats(1.0, 400.0)) * robot.axis_units
    middle = each(st.floats(-90.0, 90.0)) * robot.axis_units
    endless = each(st.sampled_from([0.0, 0.0, 0.0, np.inf]))
    limits = replace(
        robot.limits,
        lower=middle - half - endless,
        upper=middle + half + endless,
        velocity=each(st.floats(0.1, 400.0)) * robot.axis_units,
        acceleration=each(st.floats(0.1, 4000.0)) * robot.axis_units,
        stop_acceleration=each(st.floats(0.1, 4000.0)) * robot.axis_units,
    )
    controller = replace(
        robot.controller,
        axes=axes,
        motors=tuple(draw(st.permutations(range(1, 33)))[:6]),
        feedback=tuple(f"P{number}" for number in draw(st.permutations(range(8100)))[:6])
        if draw(st.booleans())
        else robot.controller.feedback,
        coordinate_system=draw(st.integers(1, 16)),
        ixx08=draw(st.integers(1, 200)),
        hold_time=draw(st.floats(0.01, 5.0)),
        largest_segment=draw(st.floats(0.01, 0.5)),
        rapid_share=draw(st.floats(0.01, 1.0)),
        i8=draw(st.integers(0, 10)),
    )
    velocity = each(st.floats(1e2, 1e6))
    return replace(
        robot,
        written=None,
        actuation=replace(robot.actuation, gear=gear, coupling=coupling, offset=offset, velocity=velocity),
        controller=controller,
        limits=limits,
    )


@settings(max_examples=150, deadline=None)
@given(robots())
def test_any_drives_are_proved(robot):
    found = judged(settings_text(robot), robot)
    assert found.diagnostics == ()


@settings(max_examples=100, deadline=None)
@given(robots(), st.integers(0, 2**32 - 1))
def test_plc_0_is_the_inverse_of_the_actuation(robot, seed):
    """PLC 0 is evaluated numerically, like by the controller. It agrees with `from_counts`, and the proved
    bounds hold.
    """
    proved = judged(settings_text(robot), robot).value
    limits = robot.limits
    lower, upper = np.maximum(limits.lower, -600.0), np.minimum(limits.upper, 600.0)
    q = lower + np.random.default_rng(seed).random(6) * (upper - lower)
    counts = to_counts(robot, q)
    scale = 32 * robot.controller.ixx08
    names = {f"M{motor}62": at * scale for motor, at in zip(robot.controller.motors, counts, strict=True)}
    names |= {f"I{motor}08": robot.controller.ixx08 for motor in robot.controller.motors}
    told = dict(line.split("=") for line in proved.content.feedback.statements)
    values = [eval(told[variable], {}, names) for variable in robot.controller.feedback]
    inverse = np.abs(joints_per_count(robot)) / robot.axis_units[:, None]
    rounding = 1e-12 * inverse @ (np.abs(counts) + np.abs(robot.actuation.offset)) + 1e-9
    # The proved bound is for the printed axis definitions, which have ten decimals. `counts` are exact, so
    # the rounding of the definitions is added.
    rounding += inverse @ np.full(robot.size, 0.5e-10 * np.abs(q / robot.axis_units).sum())
    assert (
        np.abs(values - from_counts(robot, counts) / robot.axis_units) <= proved.feedback + rounding
    ).all()
    assert (np.abs(values - q / robot.axis_units) <= proved.feedback + rounding).all()
    # The proved bounds are at most a hundredth of a count, far below the resolution of a motor.
    assert (np.maximum(proved.feedback, proved.commanded) <= inverse @ np.full(6, 0.01)).all()


@settings(max_examples=100, deadline=None)
@given(robots(), st.integers(0, 2**32 - 1))
def test_what_is_proved_of_motors_holds(robot, seed):
    """The proved properties of motors hold numerically: the motors' limits contain all allowed joint
    positions, and motors at their largest rates exceed no joint's rates by more than about 0.1 %.
    """
    content = judged(settings_text(robot), robot).value.content
    random, limits, controller = np.random.default_rng(seed), robot.limits, robot.controller

    def of(number):
        return np.array([float(content.settings[f"I{one}{number:02d}"].value) for one in controller.motors])

    lower, upper = np.maximum(limits.lower, -1e6), np.minimum(limits.upper, 1e6)
    q = np.where(random.random((200, 6)) < 0.5, lower, upper)
    counts = to_counts(robot, q)
    assert (counts <= np.where(of(13), of(13), np.inf)).all()
    assert (counts >= np.where(of(14), of(14), -np.inf)).all()
    signs = random.choice([-1.0, 1.0], (200, 6))
    for number, per, most in (
        (15, 1e6, limits.stop_acceleration),
        (16, 1e3, limits.velocity * controller.rapid_share),
        (17, 1e6, limits.acceleration),
        (19, 1e6, limits.acceleration),
        (22, 1e3, limits.velocity * controller.rapid_share),
    ):
        rates = signs * of(number) * per
        assert (np.abs(rates @ joints_per_count(robot).T) <= most * 1.00101).all()
        if per == 1e3:
            assert (np.abs(rates) <= robot.actuation.velocity * 1.00101).all()


# each change of the settings gets a finding


def changed(pattern, new, count=1):
    """Return a change of the first match, which must exist."""

    def change(text):
        edited, times = re.subn(pattern, new, text, count=count, flags=re.MULTILINE)
        assert times
        assert edited != text
        return edited

    return change


def exchanged(one, other):
    """Return a change that swaps the first matches of two patterns."""

    def change(text):
        first, second = (re.search(pattern, text, re.MULTILINE)[0] for pattern in (one, other))
        assert first != second
        return text.replace(first, "\0", 1).replace(second, first, 1).replace("\0", second, 1)

    return change


def digit(pattern):
    """Return a change of the last digit of the first match."""
    return changed(rf"({pattern})(\d)", lambda found: found[1] + str((int(found[2]) + 1) % 10))


def times(name, factor):
    """Return a change that multiplies the value of an I-variable by a factor."""
    return changed(rf"^(I\d+{name})=(-?[\d.]+)", lambda found: f"{found[1]}={float(found[2]) * factor:.4f}")


def plus(name, amount):
    return changed(rf"^({name})=(-?\d+)", lambda found: f"{found[1]}={int(found[2]) + amount}")


MUTATIONS = {
    # axis definitions
    "sign of a factor": ("Y1172", changed(r"^(#\d+->)(-?)", lambda one: one[1] + "-" * (not one[2]))),
    "sign in a coupling": (
        "Y1172",
        changed(r"^(#\d+->-?[\d.]+[XYU])([-+])", lambda one: one[1] + {"+": "-", "-": "+"}[one[2]]),
    ),
    "last digit of a factor": ("Y1172", digit(r"^#\d+->-?[\d.]+")),
    "first digit of a factor": ("Y1172", changed(r"^(#\d+->-?)\d", r"\g<1>7")),
    "another axis": ("Y1172", changed(r"^(#\d+->-?[\d.]+)A$", r"\1X")),
    "a coupled term less": ("Y1172", changed(r"^(#\d+->-?[\d.]+[XYU])[-+][\d.]+[YZV]", r"\1")),
    "a term more": ("Y1172", changed(r"^(#\d+->-?[\d.]+A)$", r"\1+1.0000X")),
    "a term of nothing": ("Y1172", changed(r"^(#\d+->-?[\d.]+A)$", r"\1+0.0000X")),
    "an offset more": ("Y1172", changed(r"^(#\d+->-?[\d.]+A)$", r"\1+0.5000")),
    "an axis twice": ("Y1170", changed(r"^(#\d+->)(-?[\d.]+A)$", r"\1\2+\2")),
    "an axis of its own": ("Y1170", changed(r"^(#\d+->-?[\d.]+)A$", r"\1W")),
    "a small letter": ("Y1170", changed(r"^(#\d+->-?[\d.]+)A$", r"\1a")),
    "an exponent": ("Y1170", changed(r"^(#\d+->-?\d[\d.]*)(?=[A-Z])", r"\1E1")),
    "an inverse kinematics": ("Y1170", changed(r"^(#\d+->).*", r"\1I")),
    "a definition less": ("Y1170", changed(r"^#\d+->.*\n", "")),
    "a definition twice": ("Y1170", changed(r"^(#\d+->.*\n)", r"\1\1")),
    "nothing defined": ("Y1170", changed(r"^(#\d+->).*", r"\g<1>0")),
    "another coordinate system": ("Y1170", changed(r"^&\d+$", "&9")),
    # registers
    "wrong register": ("Y1173", digit(r"^M\d+62->D:\$\d+\d(?=\d$)|^M\d+62->D:\$000")),
    "commanded for actual": ("Y1173", exchanged(r"(?<=61->)D:\S+", r"(?<=62->)D:\S+")),
    "wrong bit of the rotary": ("Y1175", changed(r",16,1$", ",17,1")),
    "wrong word of the rotary": ("Y1175", changed(r"(M8116->Y:\$00..)3F", r"\g<1>40")),
    "M8116 is another": ("Y1175", changed(r"^M8116", "M8117")),
    # motors
    "position scale": ("Y1174", plus(r"I\d+08", 1)),
    "positive limit too tight": ("Y1174", plus(r"I\d+13", -2)),
    "positive limit too wide": ("Y1174", plus(r"I\d+13", 3)),
    "positive limit off": ("Y1174", changed(r"^(I\d+13=).*", r"\g<1>0")),
    "negative limit too tight": ("Y1174", plus(r"I\d+14", 2)),
    "negative limit too wide": ("Y1174", plus(r"I\d+14", -3)),
    "negative limit off": ("Y1174", changed(r"^(I\d+14=).*", r"\g<1>0")),
    "abort too hard": ("Y1174", times(15, 1.01)),
    "abort too soft": ("Y1174", times(15, 0.98)),
    "no abort": ("Y1174", times(15, 0)),
    "abort backwards": ("Y1174", times(15, -1)),
    "RAPID too fast": ("Y1174", times(22, 1.01)),
    "RAPID without end": ("Y1174", times(22, 0)),
    "program speed": ("Y1174", times(16, 2)),
    "LINEAR too hard": ("Y1174", times(17, 1.5)),
    "RAPID too hard": ("Y1174", times(19, 1.01)),
    "ramp time": ("Y1174", changed(r"^(I\d+20=).*", r"\g<1>0.5")),
    "no S-curve": ("Y1174", changed(r"^(I\d+21=).*", r"\g<1>0")),
    "other speed of RAPID": ("Y1174", changed(r"^(I\d+90=).*", r"\g<1>1")),
    "no remark, and no digits": ("Y1170", changed(r"^(I\d+90=).*", r"\1")),
    "hexadecimal": ("Y1170", changed(r"^(I\d+08=).*", r"\g<1>$60")),
    "a sum": ("Y1170", changed(r"^(I\d+08=\d+)", r"\1+1")),
    "another motor": ("Y1170", changed(r"^I\d+90=", "I3390=")),
    "variables exchanged": ("Y1170", exchanged(r"^I\d+19=.*", r"^I\d+17=.*")),
    # coordinate system
    "servo clock": ("Y1174", plus("I10", 1)),
    "real-time interrupt": ("Y1174", plus("I8", 1)),
    "SPLINE by TA": ("Y1174", plus("I42", 1)),
    "low mark": ("Y1175", changed(r"^I16=\d+", "I16=1")),
    "an incomplete line": ("Y1175", changed(r"^(I16=\d+)", r"\1.5")),
    "no full mark": ("Y1175", changed(r"^(I16)=(\d+)(.*\nI17)=\d+", r"\1=\2\3=\2")),
    "segmentation": ("Y1174", plus(r"I5\d13", 10)),
    "kinematics in the controller": ("Y1174", plus(r"I5\d50", 1)),
    "override": ("Y1174", plus(r"I5\d94", 200)),
    "no hold": ("Y1174", changed(r"^(I5\d95=)\d+", r"\g<1>0")),
    "hold too hard": ("Y1174", changed(r"^(I5\d95=)(\d+)", lambda one: f"{one[1]}{2 * int(one[2])}")),
    "hold too soft": ("Y1174", changed(r"^(I5\d95=)(\d+)", lambda one: f"{one[1]}{int(one[2]) - 1}")),
    "another system's hold": ("Y1170", changed(r"^I5(\d)95=", r"I5995=")),
    # PLC 0
    "sign of a term": ("Y1173", changed(r"^(P\d+=)(-?)(?=[M(\d])", lambda one: one[1] + "-" * (not one[2]))),
    "digit of a divisor": ("Y1173", digit(r"^P\d+=.*/\d+\.")),
    "another motor's position": ("Y1173", changed(r"^(P\d+=.*)M\d+62", r"\1M1962")),
    "the commanded position": ("Y1173", changed(r"^(P\d+=.*M\d+)62", r"\g<1>61")),
    "another motor's scale": ("Y1173", changed(r"^(P\d+=.*)I\d+08", r"\1I1908")),
    "no scale": ("Y1173", changed(r"^(P\d+=.*)\(I\d+08\*32\)", r"\g<1>32")),
    "another scale": ("Y1173", changed(r"(I\d+08)\*32", r"\1*31")),
    "an offset in PLC 0": ("Y1173", changed(r"^(P\d+=.*)$(?=\nP)", r"\1+0.001")),
    "not linear": ("Y1173", changed(r"^(P\d+=)(.*)$(?=\nP8105)", r"\1\2*M762*M162")),
    "divided by a position": ("Y1173", changed(r"^(P\d+=)(.*)$(?=\nP8105)", r"\g<1>1/(\2)")),
    "divided by nothing": ("Y1173", changed(r"^(P\d+=.*)$(?=\nP8105)", r"\1/0")),
    "not closed": ("Y1173", changed(r"^(P\d+=.*)$(?=\nP8105)", r"\1+(0")),
    "too deep": ("Y1173", changed(r"^(P\d+=)(.*)$(?=\nP8105)", rf"\1{'(' * 9}\2{')' * 9}")),
    "no expression": ("Y1173", changed(r"^(P\d+=).*$(?=\nP8105)", r"\1-")),
    "a function": ("Y1173", changed(r"^(P\d+=)(.*)$(?=\nP8105)", r"\1ABS(\2)")),
    "another variable": ("Y1173", changed(r"^P\d+(=.*)$(?=\nP8105)", r"P7777\1")),
    "an assignment less": ("Y1175", changed(r"^P\d+=.*\n(?=P8105)", "")),
    "an assignment twice": ("Y1175", changed(r"^(P\d+=.*\n)(?=P8105)", r"\1\1")),
    "a command in PLC 0": ("Y1170", changed(r"^P\d+=.*\n(?=P8105)", 'CMD"A"\n')),
    "an M-variable in PLC 0": ("Y1170", changed(r"^P\d+(=.*\n)(?=P8105)", r"M1\1")),
    "an assignment behind": ("Y1170", changed(r"^(P8105=P8103\n)", r"\1P1=0\n")),
    "PLC 0 doesn't tell that it runs": ("Y1175", changed(r"^P8105=P8103\n", "")),
    "PLC 0 counts by itself": ("Y1175", changed(r"^P8105=P8103", "P8105=P8105+1")),
    "PLC 1": ("Y1170", changed(r"^OPEN PLC 0 CLEAR", "OPEN PLC 1 CLEAR")),
    "added to PLC 0": ("Y1170", changed(r"^OPEN PLC 0 CLEAR", "OPEN PLC 0")),
    "left open": ("Y1170", changed(r"^CLOSE\n(?=\n)", "")),
    # guard
    "armed by another value": ("Y1175", changed(r"^IF\(P8100=1\)", "IF(P8100=2)")),
    "the other way round": ("Y1175", changed(r"^IF\(M8116=0\)", "IF(M8116=1)")),
    "another bit": ("Y1175", changed(r"^IF\(M8116=0\)", "IF(M1=0)")),
    "it stays armed": ("Y1175", changed(r"^P8100=2\n", "")),
    "it disarms": ("Y1175", changed(r"^P8100=2", "P8100=0")),
    "an abort": ("Y1175", changed(r'^CMD"&(\d+)H"', r'CMD"&\1A"')),
    "a run": ("Y1175", changed(r'^CMD"&(\d+)H"', r'CMD"&\1R"')),
    "another system is held": ("Y1175", changed(r'^CMD"&\d+H"', r'CMD"&9H"')),
    "no hold in it": ("Y1175", changed(r'^CMD".*\n', "")),
    "no end": ("Y1175", changed(r"^ENDIF\n", "")),
    "a delay": ("Y1175", changed(r"^(IF\(M8116=0\))", r"\1\nI5111=1000")),
    "no heartbeat": ("Y1175", changed(r"^P8103=P8103\+1\n", "")),
    "a heartbeat that stands still": ("Y1175", changed(r"^P8103=P8103\+1", "P8103=P8103+0")),
    "a watchdog of another value": ("Y1175", changed(r"^IF\(P8104=1\)", "IF(P8104=2)")),
    "a watchdog that never bites": ("Y1175", changed(r"^IF\(I(\d+)12<0\)", r"IF(I\g<1>12>0)")),
    "the watchdog of a wait": ("Y1175", changed(r"^IF\(I(\d+)12<0\)", r"IF(I\g<1>11<0)")),
    "the watchdog of another system": ("Y1175", changed(r"^IF\(I5(\d)12<0\)", r"IF(I5912<0)")),
    "it bites again and again": ("Y1175", changed(r"^P8104=2\n", "")),
    "no hold of the watchdog": ("Y1175", changed(r'^(P8104=2\n)CMD".*\n', r"\1")),
    "watched from the beginning": ("Y1175", changed(r"^P8104=0", "P8104=1")),
    "the watch isn't said": ("Y1175", changed(r"^P8104=0\n", "")),
    "another PLC": ("Y1175", changed(r"^OPEN PLC 29 CLEAR", "OPEN PLC 28 CLEAR")),
    "armed from the beginning": ("Y1175", changed(r"^P8100=0", "P8100=1")),
    "not said": ("Y1175", changed(r"^P8100=0\n", "")),
    # what is running
    "no PLCs": ("Y1175", changed(r"^I5=3", "I5=0")),
    "no background PLCs": ("Y1175", changed(r"^I5=3", "I5=1")),
    "no foreground PLCs": ("Y1175", changed(r"^I5=3", "I5=2")),
    "guard isn't enabled": ("Y1175", changed(r"^ENABLE PLC 29\n", "")),
    "feedback isn't enabled": ("Y1175", changed(r"^ENABLE PLC 0\n", "")),
    "guard is disabled": ("Y1175", changed(r"^ENABLE PLC 29", "DISABLE PLC 29")),
    # additional lines
    "an output": ("Y1170", changed(r"\Z", "M11=1\n")),
    "a jog": ("Y1170", changed(r"\Z", "#1J+\n")),
    "a jog behind the system": ("Y1170", changed(r"^(&\d+)$", r"\1\n#1J+")),
    "a jog on a line": ("Y1170", changed(r"^(&\d+)$", r"\1#1J+")),
    "a variable in between": ("Y1170", changed(r"^(I42=0)", r"I5120=1\n\1")),
    "two on a line": ("Y1170", changed(r"^(I42=0)", r"\1I5120=1")),
    "disabled again": ("Y1170", changed(r"\Z", "DISABLE PLC 29\n")),
    "saved": ("Y1170", changed(r"\Z", "SAVE\n")),
    "behind spaces": ("Y1170", changed(r"^I42=0", " I42=0")),
    "a long line": ("Y1170", changed(r"^(P\d+=.*)$(?=\nP8105)", r"\1" + "+0" * 130)),
    # bytes
    "carriage returns": ("Y1170", lambda text: text.replace("\n", "\r\n")),
    "a carriage return": ("Y1170", changed(r"(; motors)$", r"\1\r#1J+")),
    "a vertical tab": ("Y1170", changed(r"(; motors)$", "\\1\x0b#1J+")),
    "a form feed": ("Y1170", changed(r"(; motors)$", "\\1\x0c#1J+")),
    "a next line": ("Y1170", changed(r"(; motors)$", "\\1\x85#1J+")),
    "a line separator": ("Y1170", changed(r"(; motors)$", "\\1\u2028#1J+")),
    "a tab": ("Y1170", changed(r"^I42=0", "I42=0\t")),
    "a NUL": ("Y1170", changed(r"(; motors)$", "\\1\0")),
    "a DEL": ("Y1170", changed(r"(; motors)$", "\\1\x7f")),
    "a full-width digit": ("Y1170", changed(r"^I42=0", "I42=\uff10")),
    "an Arabic digit": ("Y1170", changed(r"^I42=0", "I42=\u0660")),
    "a byte order mark": ("Y1170", lambda text: "\ufeff" + text),
    # the whole text
    "cut in a line": ("Y1170", lambda text: text[:-3]),
    "cut behind the motors": ("Y1170", lambda text: text[: text.index("I42=")]),
    "cut behind PLC 0": ("Y1175", lambda text: text[: text.index("; guard")]),
    "nothing": ("Y1170", lambda text: ""),
    "an empty line": ("Y1170", lambda text: "\n"),
    "no header": ("Y1170", lambda text: text.partition("\n")[2]),
    "another controller": ("Y1170", changed("Turbo PMAC", "Power PMAC")),
    "another robot": ("Y1171", changed(r"(PMAC for )\S+:", r"\1ANOTHER:")),
    "the robot as it was": ("Y1171", changed(r"^(; robot )\w{5}", r"\g<1>00000")),
    "no robot": ("Y1170", changed(r"^; robot .*\n", "")),
    "two robots": ("Y1170", changed(r"^; motors", "; robot 0000")),
    "not closed before": ("Y1170", changed(r"^CLOSE ALL\n", "")),
}


def _limits_exchanged(text):
    one = re.search(r"^I\d+13=(\d+)", text, re.MULTILINE)
    motor = one[0].partition("13=")[0]
    return text.replace(one[0], f"{motor}13=-{one[1]}")


def _registers_exchanged(text):
    (first, second, *_) = re.findall(r"^M\d+62->(\S+)", text, re.MULTILINE)
    return text.replace(first, "\0").replace(second, first).replace("\0", second)


MUTATIONS["another motor's register"] = ("Y1173", _registers_exchanged)
MUTATIONS["limits exchanged"] = ("Y1174", _limits_exchanged)


@pytest.mark.parametrize("mutation", MUTATIONS)
def test_a_change_is_one_finding(name, mutation):
    code, change = MUTATIONS[mutation]
    finding = the_finding(change(TEXTS[name]), ROBOTS[name])
    assert finding.code == code, finding.message


def columns_exchanged(text):
    """Swap Y and Z in all axis definitions."""
    swapped = {"Y": "Z", "Z": "Y"}
    return re.sub(
        r"^#.*", lambda line: re.sub("[YZ]", lambda axis: swapped[axis[0]], line[0]), text, flags=re.MULTILINE
    )


EXCHANGES = {
    "axes": ("Y1172", columns_exchanged),
    "motors": ("Y1172", exchanged(r"(?<=->)[\d.]+A$", r"(?<=->)-?[\d.]+X.*$")),
    "joints": ("Y1173", changed(r"^(P\d+)(=.*\n)(P\d+)(=.*\n)P8105", r"\3\2\1\4P8105")),
    "expressions": ("Y1173", changed(r"^(P\d+=)(.*\n)(P\d+=)(.*\n)P8105", r"\1\4\3\2P8105")),
}


@pytest.mark.parametrize("exchange", EXCHANGES)
def test_an_exchange_is_a_finding_for_each_line(name, exchange):
    code, change = EXCHANGES[exchange]
    assert {one.code for one in the_findings(change(TEXTS[name]), ROBOTS[name])} == {code}


def is_said(line):
    return bool(line.partition(";")[0].strip())


def test_no_line_may_be_missing_doubled_or_moved(name):
    robot, lines = ROBOTS[name], lines_of(TEXTS[name])
    for at, line in enumerate(lines[2:], 2):
        if not is_said(line):
            continue
        the_finding("".join(lines[:at] + lines[at + 1 :]), robot)
        the_finding("".join([*lines[:at], line, *lines[at:]]), robot)
        behind = next((other for other in range(at + 1, len(lines)) if is_said(lines[other])), None)
        if behind is not None and lines[behind] != line:
            moved = [*lines]
            moved[at], moved[behind] = lines[behind], line
            the_findings("".join(moved), robot)


def test_a_line_anywhere_is_refused(name):
    robot, lines = ROBOTS[name], lines_of(TEXTS[name])
    for at in range(len(lines) + 1):
        added = ("M11=1\n", "#1J+\n", "&1B1R\n")[at % 3]
        finding = the_finding("".join([*lines[:at], added, *lines[at:]]), robot)
        assert finding.span.line in (at + 1, at + 2)


SMALL_CHANGES = re.compile(r"I\d+1[3-7]=|I\d+(19|2[0-2])=|I1[67]=")
"""Settings in which another digit may still be proved: limits within two counts, rates within 0.1 %, ramp
times of RAPID, more lines for the guard PLC.
"""


def is_the_same(line, robot):
    """Return True if an assignment of PLC 0 still computes its joint, to a hundredth of a count."""
    name, _, expression = line.partition("=")
    joint = robot.controller.feedback.index(name)
    names = {f"I{motor}08": 1 for motor in robot.controller.motors}
    for q in np.vstack([robot.limits.lower, robot.limits.upper]):
        counts = to_counts(robot, q)
        names |= {f"M{motor}62": 32 * at for motor, at in zip(robot.controller.motors, counts, strict=True)}
        allowed = 0.01 * np.abs(joints_per_count(robot)[joint]).sum() / robot.axis_units[joint]
        if abs(eval(expression, {}, names) - q[joint] / robot.axis_units[joint]) > allowed:
            return False
    return True


def test_each_other_digit_is_one_finding_or_is_proved(name):
    """Each second digit of each line is changed. The change gives one finding, or is proved."""
    robot, lines = ROBOTS[name], lines_of(TEXTS[name])
    random = np.random.default_rng(6)
    for at, line in enumerate(lines[2:], 2):
        said = line.partition(";")[0]
        for place in [found.start() for found in re.finditer(r"\d", said)][at % 2 :: 2]:
            other = str((int(line[place]) + random.integers(1, 10)) % 10)
            edited = [*lines]
            edited[at] = line[:place] + other + line[place + 1 :]
            found = judged("".join(edited), robot)
            assert len(found.diagnostics) == (found.value is None)
            if found.value is not None:
                assert SMALL_CHANGES.match(edited[at]) or is_the_same(edited[at], robot), edited[at]


@settings(max_examples=300, deadline=None)
@given(st.sampled_from(sorted(TEXTS)), st.data())
def test_garbage_is_never_an_exception(name, data):
    """Parts of the text are deleted, duplicated or swapped, and characters are inserted. No exception is
    raised.
    """
    text = TEXTS[name]
    for _ in range(data.draw(st.integers(1, 4))):
        begin = data.draw(st.integers(0, len(text)))
        end = min(len(text), begin + data.draw(st.integers(0, 40)))
        put = data.draw(st.text(st.characters(max_codepoint=300), max_size=10) | st.just(text[begin:end] * 2))
        text = text[:begin] + put + text[end:]
    found = judged(text, ROBOTS[name])
    assert found.value is None or not found.diagnostics


def test_hostile_lines_take_no_time(name):
    for line in (
        "#1->" + "1" * 250,
        "#1->" + "1+" * 120,
        "P1=" + "(" * 250,
        "P1=" + "1/" * 120,
        "1" * 100_000,
    ):
        the_finding(changed(r"^(#\d+->.*|P\d+=.*)$", line)(TEXTS[name]), ROBOTS[name])


# errors in the writer


def off_by(function, change):
    """Return a function of the writer whose result is changed."""
    return lambda *arguments: change(function(*arguments))


def replaced(texts, old, new):
    return tuple(text.replace(old, new) for text in texts)


MUTANTS = {
    "K without J": (
        "_axis_definitions",
        lambda made: [replace(one, terms=re.sub(r"[-+][\d.]+[YZVW]", "", one.terms)) for one in made],
        "Y1172",
    ),
    "no offset": (
        "_axis_definitions",
        lambda made: [replace(one, terms=re.sub(r"[-+][\d.]+$", "", one.terms)) for one in made],
        "Y1172",
    ),
    "motors in the order of axes": ("_axis_definitions", lambda made: list(made)[::-1], "Y1170"),
    "PLC 0 forgets the offsets": ("_offset", lambda text: "+0", "Y1173"),
    "PLC 0 adds the offsets": ("_offset", lambda text: {"+": "-", "-": "+"}[text[0]] + text[1:], "Y1173"),
    "PLC 0 divides by 16": ("_feedback", lambda made: replaced(made, "*32", "*16"), "Y1173"),
    "PLC 0 transposed": ("joints_per_count", lambda matrix: matrix.T, "Y1173"),
    "PLC 0 with too few digits": ("_digits", lambda text: f"{float(text):.3g}", "Y1173"),
    "six decimals less": ("_number", lambda text: f"{float(text):.1f}", "Y1172"),
    "registers of the next motor": ("actual_position", lambda made: (made[0], made[1][:-1] + "C"), "Y1173"),
    "registers exchanged": (
        "commanded_position",
        lambda made: (made[0].replace("61", "62"), made[1]),
        "Y1173",
    ),
    "another bit": ("rotary_full", lambda made: (made[0], made[1].replace("16,1", "15,1")), "Y1175"),
    "rates of joints alone": ("_motor_rate", lambda rates: rates * 1.5, "Y1174"),
    "rates by a thousand": ("_motor_rate", lambda rates: rates / 1000, "Y1174"),
    "no limits": ("_software_limit", lambda limit: 0, "Y1174"),
    "limits to the nearest count": ("_software_limit", lambda limit: limit - 1, "Y1174"),
    "limits in degrees": ("_count_limits", lambda ends: (ends[0] / 360, ends[1] / 360), "Y1174"),
    "no low mark": ("watermarks", lambda marks: replace(marks, low=1), "Y1175"),
    "marks the wrong way round": (
        "watermarks",
        lambda marks: replace(marks, full=marks.low),
        "Y1175",
    ),
    "guard of another system": ("_guard", lambda made: replaced(made, "H", "Q"), "Y1175"),
    "guard without a condition": ("_guard", lambda made: (lines := tuple(made))[:1] + lines[2:], "Y1175"),
    "guard without a heartbeat": ("_guard", lambda made: tuple(made)[1:], "Y1175"),
    "guard without a watchdog": ("_guard", lambda made: tuple(made)[:7], "Y1175"),
    "a watchdog of another system": ("watchdog", lambda name: name.replace("I5", "I6"), "Y1175"),
}


@pytest.mark.parametrize("mutant", MUTANTS)
def test_a_wrong_writer_is_refused(monkeypatch, mutant):
    name, change, code = MUTANTS[mutant]
    monkeypatch.setattr(writer, name, off_by(getattr(writer, name), change))
    found = judged(settings_text(ROBOTS["coupled"]), ROBOTS["coupled"])
    assert found.value is None
    assert code in {one.code for one in found.diagnostics}


@pytest.mark.parametrize(
    ("field", "value"),
    [("i10", 3713706), ("i8", 1), ("hold_time", 0.5), ("ixx08", 96), ("coordinate_system", 4)],
)
def test_settings_of_another_controller_are_refused(field, value):
    """Settings of another controller are refused, even if the fingerprint is the same."""
    robot = ROBOTS["coupled"]
    other = replace(robot, controller=replace(robot.controller, **{field: value}), written=None)
    assert judged(settings_text(other), robot).value is None


def test_what_a_controller_cannot_do_is_refused():
    """A hold that is too slow for Isx95, positions that are too large for a register, and a J that can't be
    inverted.
    """
    robot = ROBOTS["INDUSTRIAL6"]
    slow = replace(robot, controller=replace(robot.controller, hold_time=8000.0))
    assert "a hold takes" in judged(settings_text(slow), slow).diagnostics[-1].message
    fine = replace(robot, actuation=replace(robot.actuation, gear=robot.actuation.gear * 1e5), written=None)
    assert "farther than the controller counts" in judged(settings_text(fine), fine).diagnostics[0].message
    flat = replace(robot, actuation=replace(robot.actuation, coupling=np.ones((6, 6))), written=None)
    text = re.sub(r"(?m)^(#\d+->).*", r"\g<1>1X", TEXTS["INDUSTRIAL6"])
    assert "can't be inverted" in the_finding(text, flat).message


# expressions


def meaning(name):
    return variable(name) if name.startswith("M") else None


def values(text, **names):
    found = evaluate(text, meaning)
    return found.constant + sum(factor * names[name] for name, factor in found.factors.items())


@pytest.mark.parametrize(
    "text",
    [
        "1+2*3",
        "-1-2-3",
        "8/4/2",
        "8/4*2",
        "2*(3-M1)/4",
        "-(M1-2)*3",
        "M1-M1",
        "(1+2)*(3)",
        "-2*M1+M2/8-0.5",
        "0.1+0.2",
    ],
)
def test_expressions(text):
    assert float(values(text, M1=3, M2=5)) == pytest.approx(eval(text, {}, {"M1": 3, "M2": 5}), abs=1e-15)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "1+",
        "*2",
        "1--2",
        "2*-3",
        "(1",
        "1)",
        "1 + 2",
        "M1*M2",
        "1/M1",
        "1/0",
        "1/(M1-M1)",
        "P1",
        "2M1",
        "1e5",
        "M1(2)",
        "1,2",
        "$10",
        "M1^2",
        "M1%2",
        "()",
        ".",
    ],
)
def test_what_is_no_sum_of_variables(text):
    with pytest.raises(NotAffineError):
        evaluate(text, meaning)
