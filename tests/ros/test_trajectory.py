"""Goals of the ROS nodes: requirements on them, the path that they ask for, and their programs."""

import ast
import dataclasses
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import yarclang
from yarclang.hir import Timetable
from yarclang.motion.paths.timed import along
from yarclang.ros.node.trajectory import (
    INVALID_GOAL,
    INVALID_JOINTS,
    MOST_POINTS,
    OLD_HEADER_TIMESTAMP,
    Goal,
    Joint,
    Point,
    Tolerance,
    fault_of,
    program_of,
    too_long,
    track_of,
)

NODE = Path(yarclang.__file__).parent / "ros" / "node"
ARM = tuple(Joint(f"J{number}", "deg") for number in range(1, 7))
TRACKED = (Joint("rail", "mm"), Joint("arm", "deg"))
NAMES = tuple(one.name for one in ARM)


def goal(*points, names=NAMES, **more):
    return Goal(names, tuple(points), **more)


def point(*positions, at=1.0, v=(), a=()):
    return Point(tuple(positions), at, tuple(v), tuple(a))


HOME = point(*[0.0] * 6, at=0.0)
THERE = point(0.1, 0.2, 0.3, 0.1, 0.2, 0.3, at=1.0)

angles = st.floats(-2.0, 2.0)
steps = st.floats(0.05, 3.0)


@st.composite
def goals(draw, size=3):
    """Draw a goal for `size` joints: positions, and perhaps velocities and accelerations."""
    count = draw(st.integers(1, 6))
    orders = draw(st.integers(1, 3))
    times = np.cumsum(draw(st.lists(steps, min_size=count, max_size=count))).tolist()
    if draw(st.booleans()):
        times = [time - times[0] for time in times]
    row = st.lists(angles, min_size=size, max_size=size).map(tuple)
    points = []
    for number, time in enumerate(times):
        rests = number == count - 1 or time == 0.0
        v = () if orders < 2 else (0.0,) * size if rests else draw(row)
        points.append(Point(draw(row), time, v, draw(row) if orders > 2 else ()))
    return Goal(tuple(f"J{number}" for number in range(1, size + 1)), tuple(points))


# requirements on a goal


@pytest.mark.parametrize(
    ("wrong", "code", "text"),
    [
        (goal(THERE, names=(*NAMES[:5], "J7")), INVALID_JOINTS, "J7 unknown; the robot has J1, J2, J3"),
        (goal(THERE, names=(*NAMES[:5], "J5")), INVALID_JOINTS, "J5 doubled"),
        (goal(THERE, names=NAMES[:5]), INVALID_JOINTS, "J6 missing"),
        (goal(THERE, names=()), INVALID_JOINTS, "J1, J2, J3, J4, J5, J6 missing"),
        (goal(), INVALID_GOAL, "no points"),
        (goal(THERE, THERE), INVALID_GOAL, "point 1: time_from_start is 1 s, and 1 s at the point before"),
        (goal(point(*[0.0] * 6, at=-1.0)), INVALID_GOAL, "point 0: time_from_start is -1 s"),
        (goal(point(*[0.0] * 6, at=math.nan)), INVALID_GOAL, "point 0: time_from_start is nan s"),
        (
            goal(point(*[0.0] * 6, at=math.inf)),
            INVALID_GOAL,
            "time_from_start is inf s: it must be a number from 0 to 1e+06",
        ),
        (goal(point(*[0.0] * 5)), INVALID_GOAL, "point 0 has 5 positions for 6 joints"),
        (goal(point(*[0.0] * 5, 1e300)), INVALID_GOAL, "positions of J6 has 1e+300"),
        (goal(HOME, dataclasses.replace(THERE, time_from_start=1e-200)), INVALID_GOAL, "times must grow"),
        (goal(dataclasses.replace(THERE, time_from_start=1e-168)), INVALID_GOAL, "motion begins at 0 s"),
        (goal(point()), INVALID_GOAL, "point 0 has no positions"),
        (goal(point(*[0.0] * 5, math.nan)), INVALID_GOAL, "point 0: positions of J6 has nan"),
        (goal(point(*[0.0] * 6, v=[0.0] * 5)), INVALID_GOAL, "5 velocities for 6 joints"),
        (
            goal(HOME, point(*[0.1] * 6, v=[0.0] * 6)),
            INVALID_GOAL,
            "point 1 has velocities, point 0 has none",
        ),
        (goal(point(*[0.1] * 6, a=[0.0] * 6)), INVALID_GOAL, "accelerations and no velocities"),
        (
            goal(point(*[0.1] * 6, v=[0.0] * 5 + [0.2])),
            INVALID_GOAL,
            "J6 has the velocity 0.2 at the last point",
        ),
        (
            goal(point(*[0.0] * 6, at=0.0, v=[0.3] * 6), point(*[0.1] * 6, v=[0.0] * 6)),
            INVALID_GOAL,
            "J1 has the velocity 0.3 at the first point, at time 0",
        ),
        (goal(THERE, path_tolerance=(Tolerance("J9", 0.1),)), INVALID_GOAL, "path_tolerance names J9"),
        (goal(THERE, goal_tolerance=(Tolerance("J9", 0.1),)), INVALID_GOAL, "goal_tolerance names J9"),
        (goal(THERE, goal_tolerance=(Tolerance("J1", math.nan),)), INVALID_GOAL, "no finite number"),
        (
            goal(THERE, path_tolerance=(Tolerance("J1", 0.1, 0.1),)),
            INVALID_GOAL,
            "only positions are watched",
        ),
        (goal(THERE, goal_time_tolerance=math.nan), INVALID_GOAL, "no finite number"),
        (goal(THERE, starts_in=math.nan), INVALID_GOAL, "no finite number"),
        (goal(THERE, starts_in=-1.5), OLD_HEADER_TIMESTAMP, "1.500 s in the past"),
    ],
)
def test_a_goal_that_makes_no_sense_is_rejected_with_the_reason(wrong, code, text):
    found = fault_of(wrong, ARM)
    assert found is not None
    assert found.error_code == code
    assert text in found.error_string


def test_too_many_points_are_rejected_at_once():
    points = tuple(dataclasses.replace(THERE, time_from_start=1.0 + n) for n in range(MOST_POINTS + 1))
    assert "at most 20000 are taken" in fault_of(goal(*points), ARM).error_string


def test_thousands_of_joint_names_make_a_short_reason():
    names = tuple(f"{'x' * 1000}{number}" for number in range(5000))
    assert len(fault_of(goal(THERE, names=names), ARM).error_string) < 2000


def test_a_tolerance_of_none_and_a_late_stamp_are_taken():
    tolerances = tuple(Tolerance(name, -1.0, -1.0, -1.0) for name in NAMES)
    taken = goal(THERE, starts_in=-0.5, path_tolerance=tolerances, goal_tolerance=tolerances)
    assert fault_of(taken, ARM) is None


@given(goals())
def test_any_goal_of_good_shape_is_taken(some):
    assert fault_of(some, ARM[:3]) is None


any_row = st.lists(st.floats(), min_size=1, max_size=4).map(tuple)
any_points = st.lists(
    st.builds(Point, any_row, st.floats(), any_row | st.just(()), any_row | st.just(())), max_size=4
).map(tuple)


@settings(max_examples=300)
@given(
    st.builds(
        Goal,
        st.permutations(["a", "b"]).map(tuple),
        any_points,
        starts_in=st.floats(),
        path_tolerance=st.lists(st.builds(Tolerance, st.text(), st.floats())).map(tuple),
        goal_time_tolerance=st.floats(),
    )
    | st.builds(
        Goal,
        st.just(("a", "b")),
        st.lists(st.floats(0.0, 1e6), min_size=1, max_size=4, unique=True).map(
            lambda times: tuple(Point((-1e6, 1e6), time, (0.0, 0.0), (1e6, -1e6)) for time in sorted(times))
        ),
    )
)
def test_any_numbers_are_rejected_or_become_a_program(some):
    joints = (Joint("a", "deg"), Joint("b", "mm"))
    found = fault_of(some, joints)
    if found is not None:
        assert 0 < len(found.error_string) < 2000
        return
    made = program_of(some, joints, (0.1, 0.2))
    assert not set("einf") & set(
        made.text.replace("(mm,deg,s)", "")
        .replace("(mm,deg)", "")
        .lower()
        .replace("movej_timed", "")
        .replace("movej", "")
        .replace("vel", "")
    )
    track = made.track
    for share in (0.0, 0.3, 1.0):
        assert all(map(math.isfinite, track.at(share * track.duration).positions))


# the path


@given(goals(), st.lists(angles, min_size=3, max_size=3))
def test_the_path_passes_through_the_points(some, stands):
    track = track_of(some, ARM[:3], tuple(stands))
    assert track.at(0.0).positions == tuple(stands)
    for one in some.points:
        if one.time_from_start > 0.0:
            there = track.at(one.time_from_start)
            assert there.positions == pytest.approx(one.positions, abs=1e-9)
            if one.velocities:
                assert there.velocities == pytest.approx(one.velocities, abs=1e-6)


@given(goals(), st.lists(angles, min_size=3, max_size=3), st.lists(st.floats(0.0, 1.0), min_size=1))
def test_the_path_is_the_one_that_the_planner_proves(some, stands, shares):
    track = track_of(some, ARM[:3], tuple(stands))
    rows = [one for one in some.points if one.time_from_start > 0.0]
    if not rows:
        return

    def table(values):
        return np.array(values) if len(values[0]) else None

    planned = along(
        Timetable(
            np.array([one.time_from_start for one in rows]),
            np.array([one.positions for one in rows]),
            table([one.velocities for one in rows]),
            table([one.accelerations for one in rows]),
        ),
        np.array(stands),
    )
    for time in (share * track.duration for share in shares):
        found = track.at(time)
        wanted = [planned.at(np.array([time]), order)[0] for order in range(2)]
        assert found.positions == pytest.approx(wanted[0], abs=1e-9)
        if 0.0 < time < track.duration:
            scale = 1.0 + np.abs(wanted[1]).max()
            assert np.abs(np.array(found.velocities) - wanted[1]).max() < 1e-7 * scale


@given(goals(), st.floats(-10.0, 100.0))
def test_before_its_start_and_after_its_end_the_robot_rests(some, time):
    track = track_of(some, ARM[:3], (0.1, 0.2, 0.3))
    if not 0.0 < time < track.duration:
        there = track.at(time)
        assert there.velocities == (0.0, 0.0, 0.0)
        assert there.positions == (track.positions[0] if time <= 0.0 else track.positions[-1])


@given(st.floats(0.05, 0.95), st.floats(-0.02, 0.02))
def test_the_nearest_time_is_found(share, off):
    track = track_of(goal(point(1.0, 0.5, -1.0, at=2.0), names=NAMES[:3]), ARM[:3], (0.0, 0.0, 0.0))
    time = 2.0 * share
    found = track.nearest(track.at(time).positions, time + off - 0.05, time + off + 0.05)
    assert found.time == pytest.approx(time, abs=1e-3)


# the program


@given(goals(), st.lists(angles, min_size=3, max_size=3), st.permutations(range(3)))
def test_any_order_of_the_joints_gives_the_same_program(some, stands, order):
    def shuffled(values):
        return tuple(values[place] for place in order) if values else ()

    other = Goal(
        shuffled(some.joint_names),
        tuple(
            Point(shuffled(p.positions), p.time_from_start, shuffled(p.velocities), shuffled(p.accelerations))
            for p in some.points
        ),
    )
    assert program_of(other, ARM[:3], tuple(stands)) == program_of(some, ARM[:3], tuple(stands))


def test_a_program_is_one_timetable_in_units_of_the_robot():
    points = (
        Point((0.0, 0.0), 0.0, (0.0, 0.0), (0.0, 0.0)),
        Point((math.pi / 2, 0.25), 1.5, (0.1, -0.002), (0.2, 0.0)),
        Point((math.pi, 0.5), 3.0, (0.0, 1e-9), (-0.2, 0.0)),
    )
    made = program_of(Goal(("arm", "rail"), points), TRACKED, (0.0, 0.0))
    assert made.text == (
        "P0020 MOVEJ_TIMED 250 90 [1.5] VEL -2 5.729578 ACC 0 11.459156;\n"
        "500 180 [3] VEL 0 0 ACC 0 -11.459156 (mm,deg,s)\n"
    )
    assert not made.has_lead


def test_the_robot_is_led_to_a_first_point_where_it_does_not_stand():
    made = program_of(goal(THERE, dataclasses.replace(HOME, time_from_start=2.0)), ARM, (0.5,) * 6)
    assert not made.has_lead  # the goal itself states the time to get there
    late = goal(
        dataclasses.replace(THERE, time_from_start=0.0), dataclasses.replace(HOME, time_from_start=2.0)
    )
    made = program_of(late, ARM, (0.5,) * 6)
    assert made.has_lead
    assert made.text.startswith("P0010 MOVEJ 5.729577951 ")
    assert made.track.positions[0] == THERE.positions
    near = program_of(late, ARM, tuple(one + 0.009 for one in THERE.positions))
    assert not near.has_lead
    assert "MOVEJ " not in near.text


def test_a_robot_that_stands_at_the_only_point_has_nothing_to_do():
    assert program_of(goal(THERE), ARM, THERE.positions).text == ""
    assert program_of(goal(dataclasses.replace(THERE, time_from_start=0.0)), ARM, THERE.positions).text == ""
    away = program_of(goal(dataclasses.replace(THERE, time_from_start=0.0)), ARM, (0.0,) * 6)
    assert away.text.count("\n") == 1
    assert away.has_lead


@settings(max_examples=15, deadline=None)
@given(goals(size=6).filter(lambda one: one.points[-1].time_from_start > 0.0))
def test_the_language_takes_any_program_of_a_goal(some):
    small = dataclasses.replace(
        some,
        points=tuple(
            dataclasses.replace(one, positions=tuple(0.2 * q for q in one.positions)) for one in some.points
        ),
    )
    made = program_of(small, ARM, (0.0,) * 6)
    found = yarclang.check(made.text, robot="INDUSTRIAL6") if made.text else []
    early = [one for one in found if one.code < "Y0500" and one.severity == "error"]
    assert early == []


def test_a_goal_whose_text_is_too_long_is_refused_with_its_length():
    row = tuple(0.123456789 * n for n in range(1, 7))
    points = tuple(Point(row, 0.1 + 0.1 * n, row, row) for n in range(MOST_POINTS - 1))
    last = Point(row, 1e5, (0.0,) * 6, row)
    made = program_of(goal(*points, last), ARM, (0.0,) * 6)
    assert "MiB are taken: thin it" in too_long(made)
    short = program_of(goal(*points[:9000], last), ARM, (0.0,) * 6)
    assert too_long(short) is None


# modules that the nodes import


def test_the_nodes_import_the_standard_library_and_the_client_alone():
    allowed = sys.stdlib_module_names | {"__future__"}
    for path in NODE.glob("*.py"):
        if path.stem in ("ros1", "ros1_shell", "ros2", "ros2_shell", "interfaces"):
            continue  # these modules may import ROS
        for node in ast.walk(ast.parse(path.read_bytes(), feature_version=(3, 8))):
            names = [one.name for one in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom):
                names = [node.module]
            for name in names:
                own = name == "yarclang.client" or name.startswith("yarclang.ros.node")
                assert own or name.split(".")[0] in allowed, f"{path.name}: {name}"


def test_the_driver_is_imported_without_any_package():
    code = (
        f"import sys; sys.path.insert(0, {str(NODE.parents[2])!r}); import yarclang.ros.node.driver; "
        "print(*sorted({name.split('.')[0] for name in sys.modules} - sys.stdlib_module_names))"
    )
    run = subprocess.run([sys.executable, "-S", "-I", "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["__main__", "yarclang"] or run.stdout.split() == ["yarclang"]
