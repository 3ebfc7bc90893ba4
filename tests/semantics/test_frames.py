"""Tests of a program's frames, compared with products of matrices by scipy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import checked, codes
from scipy.spatial.transform import Rotation

from yarclang.robot.description import load_robot

DEFAULT = "DEFAULT {TCP} [5] (mm,deg,s) {B}\n"
SIX = st.tuples(*[st.integers(-500, 500)] * 3, *[st.integers(-170, 170)] * 3)


def matrix(values):
    """Return the matrix of x y z [mm] roll pitch yaw [deg], independently of the compiler."""
    made = np.eye(4)
    made[:3, :3] = Rotation.from_euler("xyz", values[3:], degrees=True).as_matrix()
    made[:3, 3] = np.array(values[:3]) / 1000
    return made


def text(values):
    return " ".join(map(str, values))


@given(st.lists(SIX, min_size=1, max_size=5), SIX)
def test_a_chain_of_frames_is_the_product_of_its_matrices(chain, goal):
    lines, base, product = [], "B", np.eye(4)
    for number, values in enumerate(chain):
        lines.append(f"FRAME {{F{number}}} {text(values)} {{{base}}}")
        base, product = f"F{number}", product @ matrix(values)
    program, found = checked(DEFAULT + "\n".join([*lines, f"P0010 MOVEL {text(goal)} {{{base}}}"]))
    assert codes(found) == []
    assert np.allclose(program.steps[0].goal.base_from_moving, product @ matrix(goal), atol=1e-12)


@given(SIX, SIX)
def test_tools_hang_on_the_flange_or_on_tools(tool, tip):
    lines = f"FRAME {{TORCH}} {text(tool)} {{FLANGE}}\nFRAME {{TIP}} {text(tip)} {{TORCH}}\n"
    lines += f"FRAME {{BEHIND}} {text(tip)} {{TCP}}\n"
    moves = [f"P00{n}0 MOVEL {{{name}}} 0 0 0 0 0 0" for n, name in enumerate(("TIP", "BEHIND"), 1)]
    program, found = checked(DEFAULT + lines + "\n".join(moves))
    assert codes(found) == []
    first, second = (step.goal.flange_from_moving for step in program.steps)
    tcp = load_robot("INDUSTRIAL6").value.flange_from_frame["TCP"]
    assert np.allclose(first, matrix(tool) @ matrix(tip), atol=1e-12)
    assert np.allclose(second, tcp @ matrix(tip), atol=1e-12)


@given(SIX)
def test_frame_quat(values):
    quaternion = Rotation.from_euler("xyz", values[3:], degrees=True).as_quat()
    quat = " ".join(f"{part:.15f}" for part in quaternion)
    lines = f"FRAME_QUAT {{Q}} {text(values[:3])} {quat} {{B}}\nP0010 MOVEL 0 0 0 0 0 0 {{Q}}"
    program, found = checked(DEFAULT + lines)
    assert codes(found) == []
    assert np.allclose(program.steps[0].goal.base_from_moving, matrix(values), atol=1e-9)


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("FRAME {A} 0 0 0 0 0 0 {FLANGE}\nP0010 MOVEL 0 0 0 0 0 0 {A}", ["Y0303"]),
        ("FRAME {A} 0 0 0 0 0 0 {FLANGE}\nP0010 DMOVE 0 0 1 0 0 0 {A}", []),
        ("FRAME {A} 0 0 0 0 0 0\nP0010 MOVEL {A} 0 0 0 0 0 0", ["Y0303"]),
        ("FRAME {A} 0 0 0 0 0 0 {C}\nP0010 MOVEL 0 0 0 0 0 0 {A}", ["Y0301"]),
        ("FRAME {A} 0 0 0\nP0010 MOVEL 0 0 0 0 0 0 {A}", ["Y0401"]),
        ("FRAME_QUAT {A} 0 0 0 0 0 0 2\nP0010 STOP", ["Y0404"]),
        ("FRAME 0 0 0 0 0 0\nP0010 STOP", ["Y0302"]),
        ("FRAME {A} 0 0 0 0 0 0 [5]\nP0010 STOP", ["Y0408"]),
    ],
)
def test_refused(program, expected):
    assert codes(checked(DEFAULT + program)[1]) == expected
