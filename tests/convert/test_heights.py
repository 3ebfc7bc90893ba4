"""Tests of height fields: they become closed meshes that contain everything below the measured heights."""

import io
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.cli.yarc import main
from yarclang.collision.geometry import encloses, geometry_of
from yarclang.convert import heights as converting
from yarclang.meshes.heights import below, heights_of
from yarclang.meshes.voxels import TooMany
from yarclang.shapes import Mesh


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def invoked(*arguments):
    return CliRunner().invoke(main, ["import", *arguments])


def saved(values):
    file = io.BytesIO()
    np.save(file, values)
    return file.getvalue()


def closed(triangles):
    """Return True if each edge belongs to an even number of triangles."""
    _, of = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    faces = of.reshape(-1, 3)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    return (count % 2 == 0).all()


@exercises(holes=0.3, joined=0.3, between=0.5)
@settings(max_examples=80, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_what_is_below_a_known_height_is_inside(tally, seed):
    """The mesh is closed, and its triangles face outwards.

    It contains everything below the measured heights and below bilinear surfaces between them.
    """
    rng = np.random.default_rng(seed)
    rows, columns = rng.integers(2, 12, 2)
    field = rng.normal(scale=rng.choice([1.0, 30.0]), size=(rows, columns))
    if rng.random() < 0.5:
        field[rng.random(field.shape) < 0.4] = np.nan
        field[rng.integers(rows), rng.integers(columns)] = 3.0
    every, spacing = int(rng.integers(1, 4)), float(rng.uniform(0.5, 20.0))
    triangles = below(field, spacing, every, 10**6)
    assert closed(triangles)
    assert np.einsum("ti,ti->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) > 0.0
    known = np.argwhere(np.isfinite(field))
    slightly = 1e-6
    inner = [one for one in known if (one > 0).all() and (one < np.array(field.shape) - 1).all()]
    for i, j in inner[:10]:
        assert encloses(triangles, np.array([j * spacing, i * spacing, field[i, j] - slightly]))
    asked = 0
    for _ in range(20):
        i, j = rng.integers(rows - 1), rng.integers(columns - 1)
        four = field[i : i + 2, j : j + 2]
        if not np.isfinite(four).all():
            continue
        u, v = rng.uniform(0.05, 0.95, 2)
        height = np.array([1 - v, v]) @ four @ np.array([1 - u, u])
        assert encloses(triangles, np.array([(j + u) * spacing, (i + v) * spacing, height - slightly]))
        asked += 1
    tally.count("holes", not np.isfinite(field).all())
    tally.count("joined", every > 1)
    tally.count("between", asked > 3)


def test_a_plane_of_one_cell():
    triangles = below(np.full((2, 2), 5.0), 10.0, 1, 100)
    assert len(triangles) == 12
    assert triangles.min(axis=(0, 1)) == pytest.approx([0.0, 0.0, -5.0])
    assert triangles.max(axis=(0, 1)) == pytest.approx([10.0, 10.0, 5.0])


def test_more_cells_are_joined_than_there_are():
    triangles = below(np.zeros((5, 4)), 10.0, 10**9, 100)
    assert triangles.max(axis=(0, 1)) == pytest.approx([40.0, 40.0, 0.0])


def test_rows_go_along_y():
    field = np.zeros((2, 3))
    field[1, 2] = 7.0
    top = below(field, 10.0, 1, 100).reshape(-1, 3)
    assert top[np.argmax(top[:, 2])] == pytest.approx([20.0, 10.0, 7.0])


def test_too_many_triangles_are_counted_and_not_made():
    made = below(np.zeros((2000, 2000)), 1.0, 1, 1000)
    assert isinstance(made, TooMany)
    assert made.triangles > 4 * 1999**2


@pytest.mark.parametrize("kind", ["<f8", ">f4", "<i2", "u1"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_arrays_of_all_kinds(kind, order):
    values = np.array([[1, 2, 3], [4, 5, 60]]).astype(kind)
    assert np.array_equal(heights_of(".NPY", saved(np.asarray(values, order=order))), values.astype(float))


@pytest.mark.parametrize(
    "text",
    [
        b"1,2,3\n4,,6\n",
        b"1;2;3\r\n4;nan;6",
        b"# mm\n1 2 3\n\n4 nan  6\n",
        b"\xef\xbb\xbf1\t2\t3\n4\tnan\t6\n",
    ],
)
def test_tables_of_all_kinds(text):
    found = heights_of(".csv", text)
    np.testing.assert_array_equal(found, [[1.0, 2.0, 3.0], [4.0, np.nan, 6.0]])


@pytest.mark.parametrize(
    ("suffix", "content", "words"),
    [
        (".npy", b"", "isn't a file of numpy's"),
        (".npy", b"\x93NUMPY\x01\x00\x10\x00{'descr': '<f8'", "isn't a file of numpy's"),
        (".npy", saved(np.zeros((3, 3)))[:-8], "has 64 bytes of values, but its shape needs 72"),
        (".npy", saved(np.zeros(9)), "has an array of 1 dimensions"),
        (".npy", saved(np.zeros((2, 2), dtype=complex)), "aren't numbers"),
        (".npy", saved(np.zeros((1, 5))), "has 1 x 5 heights"),
        (".npy", saved(np.zeros((2, 2))).replace(b"(2, 2)", b"(2,-2)"), "has an array"),
        (".csv", b"", "no line"),
        (".csv", b"x,y,z\n1,2,3\n", "row 1 that isn't a number"),
        (".csv", b"1,2,3\n1,2\n", "has 3 values in its first row, but 2 in row 2"),
        (".csv", b"1;2\n1,5;2\n", "row 2 that isn't a number"),
        (".csv", b"1,2\n3,4 5\n", "row 2 that isn't a number"),
    ],
)
def test_what_is_no_height_field_is_refused(suffix, content, words):
    found = heights_of(suffix, content)
    assert isinstance(found, str)
    assert words in found


@exercises(refused=0.3)
@settings(max_examples=200, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_damaged_files_are_read_or_refused_in_words(tally, seed):
    rng = np.random.default_rng(seed)
    content = bytearray(saved(rng.normal(size=(4, 5))) if rng.random() < 0.5 else b"1,2,3\n4,5,6\n7,8,9\n")
    for _ in range(int(rng.integers(1, 6))):
        content[rng.integers(len(content))] = rng.integers(256)
    if rng.random() < 0.3:
        del content[rng.integers(len(content)) :]
    found = heights_of(".npy" if content[:1] == b"\x93" else ".csv", bytes(content))
    tally.count("refused", isinstance(found, str))
    assert isinstance(found, str) or found.ndim == 2


def test_a_field_becomes_an_obstacle(tmp_path):
    field = np.zeros((20, 30))
    field[5:15, 10:20] = 0.3
    field[0, 0] = np.inf
    np.save("ground.npy", field)
    done = invoked("ground.npy", "--units", "m", "--spacing", "50")
    assert done.exit_code == 0, done.stderr
    assert "20 x 30 heights (1 left out, which aren't numbers) 50 mm apart" in done.stdout
    made = geometry_of(Mesh(tmp_path / "ground.stl", 1e-3, ""))
    assert made.skin is not None
    assert encloses(made.skin, np.array([0.75, 0.5, 0.29]))
    assert not encloses(made.skin, np.array([0.2, 0.5, 0.05]))


def test_a_table_is_a_field_with_spacing_and_a_program_without():
    Path("ground.csv").write_text("1,2,3\n4,5,6\n")
    assert invoked("ground.csv", "--units", "mm", "--spacing", "10").exit_code == 0
    assert (
        "ground.stl" in invoked("ground.csv", "--units", "mm", "--spacing", "10").stderr
    )  # the file exists already, which is reported


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("g.npy", "--units", "mm"), "give it with --spacing MM"),
        (("g.npy", "--spacing", "10"), "doesn't name its unit"),
        (("g.npy", "--units", "mm,deg", "--spacing", "10"), "doesn't name its unit"),
        (("g.npy", "--units", "mm", "--spacing", "0"), "spacing"),
        (("g.npy", "--units", "mm", "--spacing", "10", "--voxel", "3"), "--voxel: not for a height field"),
        (("g.npy", "--units", "mm", "--spacing", "10", "--time", "MIN"), "--time: not for a height field"),
        (("g.pcd", "--units", "mm", "--voxel", "10", "--spacing", "3"), "--spacing: not for a point cloud"),
        (("g.yaml", "--spacing", "3"), "--spacing is for height fields"),
        (("g.npy", "--units", "mm", "--spacing", "10", "-o", "g.obj"), "is an .stl file"),
    ],
)
def test_wrong_usage(arguments, words):
    done = invoked(*arguments)
    assert done.exit_code == 2
    assert words in " ".join(done.stderr.split())


@pytest.mark.parametrize(
    ("values", "spacing", "code", "words"),
    [
        (np.full((3, 3), np.nan), "10", "Y0962", "has no height"),
        (np.full((3, 3), 1e9), "10", "Y0962", "check its unit"),
        (np.zeros((3, 3)), "1e9", "Y0962", "--spacing"),
    ],
)
def test_what_becomes_nothing_is_said(values, spacing, code, words):
    np.save("g.npy", values)
    done = invoked("g.npy", "--units", "mm", "--spacing", spacing)
    assert done.exit_code == 1
    assert code in done.stderr
    assert words in " ".join(done.stderr.split())


def test_the_remedy_for_too_many_triangles_helps(monkeypatch):
    monkeypatch.setattr(converting, "MOST_TRIANGLES", 2000)
    np.save("g.npy", np.random.default_rng(0).normal(size=(100, 130)))
    done = invoked("g.npy", "--units", "mm", "--spacing", "10")
    assert done.exit_code == 1
    assert "Y0963" in done.stderr
    every = done.stderr.split("--every ")[1].split()[0]
    again = invoked("g.npy", "--units", "mm", "--spacing", "10", "--every", every)
    assert again.exit_code == 0, again.stderr
