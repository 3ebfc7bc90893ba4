"""Tests of reading a cell.toml: it becomes a cell in SI units, or findings at its lines, and no bytes cause a
traceback.
"""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from conftest import EXAMPLES
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from programs import checked, codes, source

from yarclang.cell.description import Names, load_cell, read_cell
from yarclang.cell.model import HalfSpace, JointWindow, ShapeRegion
from yarclang.findings.y13_cell import FINDINGS
from yarclang.robot.description import load_robot, stdlib_folder
from yarclang.semantics.declared.meanings import is_word
from yarclang.shapes import Box, Capsule, Cylinder, Mesh, Sphere
from yarclang.transforms import rpy_rotation

HERE = Path(__file__).parent
TOML = (EXAMPLES / "cell.toml").read_text()


def read(text, robot="INDUSTRIAL6", folder=HERE):
    names = Names(is_word, load_robot(robot).value if robot else None)
    return read_cell(source(text, "cell.toml"), folder, names)


def body(lines, units="mm,deg,s", folder=HERE):
    result = read(
        f'units = "{units}"\n[frames]\nA = {{ parent = "B", xyz = [0, 0, 1] }}\n{lines}', folder=folder
    )
    assert codes(result.diagnostics) == []
    return result.value


@pytest.mark.parametrize("robot", ["INDUSTRIAL6", "TRACKED_MANIPULATOR"])
def test_the_example_for_both_robots(robot):
    result = load_cell(EXAMPLES / "cell.toml", Names(is_word, load_robot(robot).value))
    assert result.diagnostics == ()
    cell = result.value
    assert list(cell.frames) == ["FIXTURE", "GRIPPER", "LEFT", "RIGHT"]
    assert cell.frames["LEFT"].mount.transform[:3, 3] == pytest.approx([-0.12, 0.62, 0.56])
    assert not cell.frames["LEFT"].mount.on_flange
    assert cell.frames["GRIPPER"].mount.on_flange
    assert np.degrees(cell.joints["READY"]) == pytest.approx([0, -15, -25, 0, -50, 0])
    assert cell.inputs == {"CLAMPED": "M11"}
    assert [(one.variable, one.safe) for one in cell.outputs.values()] == [("M1", None), ("M2", 0.0)]
    bench, fingers = cell.obstacles
    assert bench.margin == pytest.approx(0.01)
    assert bench.mount.transform[:3, 3] == pytest.approx([0, 0.62, 0.18])
    assert fingers.mount.on_flange
    floor, fixture = cell.zones
    assert (floor.rule, fixture.rule, fixture.speed) == ("allowed", "slow", pytest.approx(0.25))
    assert (floor.region.normal, floor.region.offset) == (pytest.approx([0, 0, 1]), pytest.approx(0.05))
    for array in (cell.joints["READY"], bench.mount.transform, bench.shape.size, floor.region.normal):
        assert array.dtype == np.float64
        assert not array.flags.writeable


def test_shapes(tmp_path):
    (tmp_path / "Press.STL").write_bytes(b"solid a\nendsolid a\n")
    head = '[[obstacles]]\nname = "A"\nframe = "A"\n'
    shapes = [
        ('shape = "box"\nsize = [1, 2, 3]', Box),
        ('shape = "sphere"\nradius = 1', Sphere),
        ('shape = "cylinder"\nradius = 1\nlength = 2', Cylinder),
        ('shape = "capsule"\nradius = 1\nlength = 2', Capsule),
        ('shape = "mesh"\nfile = "Press.STL"\nunits = "in"', Mesh),
    ]
    made = [body(head + text, "cm", tmp_path).obstacles[0] for text, _ in shapes]
    assert [type(one.shape) for one in made] == [kind for _, kind in shapes]
    assert made[0].shape.size == pytest.approx([0.01, 0.02, 0.03])
    assert (made[1].shape.radius, made[3].shape.length) == (pytest.approx(0.01), pytest.approx(0.02))
    mesh = made[4].shape
    assert (mesh.path, mesh.unit, len(mesh.digest)) == (tmp_path / "Press.STL", 0.0254, 64)
    assert made[0].margin == 0.0


def test_regions():
    head = '[[zones]]\nname = "Z"\nrule = "forbidden"\n'
    box = body(f'{head}shape = "box"\nframe = "A"\nsize = [10, 20, 30]\nrpy = [0, 0, 90]').zones[0].region
    assert isinstance(box, ShapeRegion)
    assert box.base_from_shape[:3, 0] == pytest.approx([0, 1, 0])
    assert box.shape.size == pytest.approx([0.01, 0.02, 0.03])
    half = (
        body(f'{head}shape = "half-space"\nframe = "A"\nxyz = [0, 0, 4]\nnormal = [0, 0, -5]').zones[0].region
    )
    assert isinstance(half, HalfSpace)
    assert half.normal == pytest.approx([0, 0, -1])
    assert half.offset == pytest.approx(-0.005)
    window = body(f'{head}shape = "joints"\njoints = {{ j2 = [-90, 45] }}').zones[0].region
    assert isinstance(window, JointWindow)
    assert np.degrees(window.lower) == pytest.approx([-np.inf, -90, *[-np.inf] * 4])
    assert np.degrees(window.upper) == pytest.approx([np.inf, 45, *[np.inf] * 4])


@pytest.mark.parametrize(
    ("text", "shape"),
    [
        ('shape = "sphere"\nradius = 2', Sphere(0.002)),
        ('shape = "cylinder"\nradius = 2\nlength = 5', Cylinder(0.002, 0.005)),
        ('shape = "capsule"\nradius = 2\nlength = 5', Capsule(0.002, 0.005)),
    ],
)
def test_zones_have_the_simple_shapes_of_obstacles(text, shape):
    zone = body(f'[[zones]]\nname = "Z"\nrule = "allowed"\nframe = "A"\nxyz = [0, 0, 3]\n{text}').zones[0]
    assert zone.region.shape == shape
    assert zone.region.base_from_shape[:3, 3] == pytest.approx([0, 0, 0.004])


def test_what_a_zone_watches():
    head = (
        '[[zones]]\nname = "Z"\nrule = "forbidden"\nshape = "half-space"\nframe = "A"\nnormal = [0, 0, 1]\n'
    )
    assert body(head).zones[0].watch == ("tool",)
    zone = body(head + 'watch = ["TCP", "elbow", "link_4"]\nmargin = 20').zones[0]
    assert (zone.watch, zone.margin) == (("tcp", "elbow", "link_4"), pytest.approx(0.02))


def test_a_posture_for_a_place():
    head = '[[zones]]\nname = "Z"\nrule = "posture"\nshape = "sphere"\nframe = "A"\nradius = 100\n'
    zone = body(head + "joints = { J3 = [-90, 0] }").zones[0]
    assert np.degrees(zone.posture.lower[2]) == pytest.approx(-90)
    assert zone.region.shape == Sphere(0.1)
    assert codes(read('units = "mm"\n' + head.replace('"A"', '"B"')).diagnostics) == ["Y1304"]


@pytest.mark.parametrize(
    ("shape", "is_fine"),
    [
        ('shape = "box"\nframe = "A"\nsize = [100, 0.09, 100]', False),
        ('shape = "box"\nframe = "A"\nsize = [100, 0.11, 100]', True),
        ('shape = "box"\nframe = "A"\nsize = [100, 0.01, 100]\nmargin = 0.05', True),
        ('shape = "box"\nframe = "A"\nsize = [100, 0.01, 100]\nmargin = 0.04', False),
        ('shape = "cylinder"\nframe = "A"\nradius = 500\nlength = 0.05', False),
        ('shape = "cylinder"\nframe = "A"\nradius = 0.01\nlength = 500', False),
        ('shape = "sphere"\nframe = "A"\nradius = 0.02', False),
        ('shape = "capsule"\nframe = "A"\nradius = 0.02\nlength = 300', False),
        ('shape = "joints"\njoints = { J1 = [10, 10.0001] }', False),
        ('shape = "joints"\njoints = { J1 = [10, 10.1] }', True),
    ],
)
@pytest.mark.parametrize("rule", ["forbidden", "allowed"])
def test_a_zone_that_could_be_crossed_unseen_is_refused(rule, shape, is_fine):
    head = 'units = "mm,deg,s"\n[frames]\nA = { parent = "B", xyz = [0, 0, 1] }\n'
    result = read(f'{head}[[zones]]\nname = "Z"\nrule = "{rule}"\n{shape}')
    found = [code for code in codes(result.diagnostics) if code == "Y1376"]
    # an allowed zone that is too thin needs no proof, because nothing fits inside
    assert found == ([] if is_fine or rule == "allowed" else ["Y1376"])


numbers = st.floats(-200, 200).map(lambda value: round(value, 3))
poses = st.lists(numbers, min_size=6, max_size=6)


@given(st.lists(st.tuples(poses, st.booleans()), min_size=1, max_size=5), st.randoms())
@settings(max_examples=30)
def test_frames_in_any_order_are_those_of_frame_lines(chain, random):
    """A chain of frames in a cell has the same poses as FRAME lines with these values, in any order of the
    file.
    """
    lines, tables, parent = [], [], "B"
    for at, (pose, _) in enumerate(chain):
        lines.append(f"FRAME {{F{at}}} {' '.join(map(str, pose))} (mm,deg) {{{parent}}}")
        tables.append(f'F{at} = {{ parent = "{parent}", xyz = {pose[:3]}, rpy = {pose[3:]} }}')
        parent = f"F{at}"
    random.shuffle(tables)
    cell = read('units = "mm,deg"\n[frames]\n' + "\n".join(tables)).value
    line = f"P0010 MOVEJ_RPY {{TCP}} 0 0 0 0 0 0 [MIN] (mm,deg) {{{parent}}}"
    program, found = checked("\n".join([*lines, line]))
    assert codes(found) == []
    assert cell.frames[parent].mount.transform == pytest.approx(
        program.steps[0].goal.base_from_moving, abs=1e-12
    )


@given(st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 0.1))
def test_a_quaternion_is_a_rotation(values):
    quaternion = (np.array(values) / np.linalg.norm(values)).tolist()
    cell = read(f'[frames]\nA = {{ parent = "FLANGE", quat = {quaternion} }}').value
    rotation = cell.frames["A"].mount.transform[:3, :3]
    assert rotation @ rotation.T == pytest.approx(np.eye(3), abs=1e-9)
    assert np.trace(rotation) == pytest.approx(4 * quaternion[3] ** 2 - 1, abs=1e-9)


@pytest.mark.parametrize(("units", "scale"), [("mm,deg", 1.0), ("m,deg", 1e-3), ("in,rad", 1 / 25.4)])
def test_units_say_the_same_place(units, scale):
    angle = 1.0 if "deg" in units else np.pi / 180
    frame = (
        f'{{ parent = "B", xyz = {[10 * scale, 20 * scale, 30 * scale]}, rpy = '
        f"{[5 * angle, 6 * angle, 7 * angle]} }}"
    )
    expected = rpy_rotation(np.radians([5, 6, 7]))
    for text in (
        f'units = "{units}"\n[frames]\nA = {frame}',
        f'units = "cm,rad"\n[frames]\nA = {frame[:-1]}, units = "{units}" }}',
    ):
        transform = read(text).value.frames["A"].mount.transform
        assert transform[:3, 3] == pytest.approx([0.01, 0.02, 0.03])
        assert transform[:3, :3] == pytest.approx(expected)


def test_without_a_robot_all_is_checked_that_holds_for_any():
    text = TOML.replace("[0, -15, -25, 0, -50, 0]", "[0, 500]").replace(
        "size = [600, 300, 300]", "size = [600]"
    )
    assert codes(read(text, None).diagnostics) == ["Y1309"]
    assert codes(read(text).diagnostics) == ["Y1309", "Y1309"]
    assert read(TOML, None).value is None


def test_a_broken_entry_is_known_by_its_name():
    result = read(TOML.replace('"M11"', '"X11"'))
    assert codes(result.diagnostics) == ["Y0413"]
    assert ("inputs", "CLAMPED") in result.value.places
    assert not result.value.inputs


def test_a_joint_that_slides_takes_lengths(tmp_path):
    arm = tmp_path / "arm"
    shutil.copytree(stdlib_folder() / "robots" / "industrial6", arm)
    urdf = (arm / "industrial6.urdf").read_text()
    limits = r'(<joint name="J2" type=")revolute(".*?lower=")[^"]*(" upper=")[^"]*'
    (arm / "industrial6.urdf").write_text(re.sub(limits, r"\1prismatic\2-1\g<3>1", urdf, flags=re.DOTALL))
    robot = load_robot(str(arm)).value
    assert robot is not None
    text = 'units = "m,rad"\n[joints]\nREADY = [0.1, 0.05, 0.3, 0, 0.1, 0]'
    cell = read_cell(source(text), HERE, Names(is_word, robot)).value
    assert cell.joints["READY"] == pytest.approx([0.1, 0.05, 0.3, 0, 0.1, 0])
    missing = read_cell(source(text.replace("m,rad", "rad")), HERE, Names(is_word, robot))
    assert codes(missing.diagnostics) == ["Y0304"]


WRAPPED = {
    "Y1370": 'units = "deg"\n[frames.A]\nparent = "B"\n{}',
    "Y1371": 'units = "mm"\n{}',
    "Y1372": 'units = "deg"\n[[zones]]\nname = "Z"\nrule = "allowed"\nshape = "joints"\n{}',
}


@pytest.mark.parametrize(
    "finding", [one for one in FINDINGS if one.code in WRAPPED], ids=lambda one: one.code
)
def test_examples_of_findings(finding):
    assert codes(read(WRAPPED[finding.code].format(finding.example)).diagnostics) == [finding.code]
    assert codes(read(WRAPPED[finding.code].format(finding.better)).diagnostics) == []


def check_any(result):
    """Check the properties that every finding must have."""
    for finding in result.diagnostics:
        assert finding.message.endswith(".")
        assert finding.help
        assert len(finding.message) < 300
        if finding.span is not None:
            assert 1 <= finding.span.line <= max(1, len(finding.source.lines))
    assert len(set(result.diagnostics)) == len(result.diagnostics)


QUICK = settings(
    max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture], derandomize=True
)


@QUICK
@given(content=st.binary(max_size=200))
@example(content=b"")
@example(content=b"\xff\xfe\x00")
@example(content=b"obstacles = 5\nzones = [1, 2]\nframes = []\njoints = 3\nunits = 4")
@example(content=b"[obstacles]\nname = 1")
@example(content=b"[[zones]]\njoints = {}\n[[frames]]\n")
@example(content=b"joints = { A = { values = 1979-05-27 } }")
def test_any_bytes(tmp_path, content):
    (tmp_path / "cell.toml").write_bytes(content)
    check_any(load_cell(tmp_path / "cell.toml", Names(is_word, load_robot("INDUSTRIAL6").value)))
    check_any(load_cell(tmp_path / "cell.toml", Names(is_word)))


PLACES = [match.span() for match in re.finditer(r'[\w.]+|"[^"]*"|[\[\]=,{}]|\n', TOML)]
ODD = [
    "",
    "nan",
    "-inf",
    "1e400",
    '""',
    '"x"',
    '"B"',
    '"FLANGE"',
    "[]",
    "{}",
    "-1",
    "0",
    "[[1]]",
    "é",
    "\n",
    "true",
]


@QUICK
@given(st.lists(st.tuples(st.integers(0, len(PLACES) - 1), st.sampled_from(ODD)), min_size=1, max_size=4))
def test_any_change(edits):
    text = TOML
    for at, new in sorted(dict(edits).items(), reverse=True):
        start, end = PLACES[at]
        text = text[:start] + new + text[end:]
    check_any(read(text))
    check_any(read(text, None))
