"""`yarc reach` draws the positions that the arm can hold, as its own forward kinematics confirm."""

import numpy as np
import pytest

from tests.robot.made_arms import made, urdf_of, yarc
from yarclang.robot.holding import sections

Z, X = (0, 0, 1), (1, 0, 0)


def test_a_planar_arm_of_two_links_is_a_ring(tmp_path):
    """The reach of a planar arm with two joints is a ring.

    Its links are 0.5 and 0.3 m long, so the inner radius is 0.2 m. Its parallel axes allow four orientations
    of a cube.
    """
    joints = [
        ("revolute", (0, 0, 0.2), (0, 0, 0), Z, (-3.14, 3.14)),
        ("revolute", (0.5, 0, 0), (0, 0, 0), Z, (-3.14, 3.14)),
    ]
    text = urdf_of(joints).replace('<origin xyz="0.05 0.02 0.1"/>', '<origin xyz="0.3 0 0"/>')
    (tmp_path / "a.urdf").write_text(text)
    side, above = sections(made(tmp_path / "a.urdf", tmp_path / "r"))
    assert side.across[0] == pytest.approx(0.2, abs=2e-3)
    assert side.across[-1] == pytest.approx(0.8, abs=2e-3)
    assert np.nanmax(above.share) <= 4 / 24
    middle = len(above.across) // 2
    assert np.isnan(above.share[middle, middle])


def test_a_wrist_holds_all_orientations(industrial6):
    side, _ = sections(industrial6)
    assert (side.share == 1.0).sum() > 100


def test_it_draws_the_same_bytes(tmp_path):
    for name in ("a.png", "b.png"):
        result = yarc("reach", "INDUSTRIAL6", "-o", tmp_path / name)
        assert result.exit_code == 0, result.output
    one, other = ((tmp_path / name).read_bytes() for name in ("a.png", "b.png"))
    assert one == other
    assert one.startswith(b"\x89PNG")


def test_what_cannot_be_drawn(tmp_path):
    assert yarc("reach", "INDUSTRIAL6", "-o", tmp_path / "a.jpg").exit_code == 2
    assert yarc("reach", tmp_path).exit_code == 1
