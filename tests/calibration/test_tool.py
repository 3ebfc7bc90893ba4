"""Tests of a tool's tip from touches of one point, compared with known tips."""

import numpy as np
import pytest
from floors import exercises
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from yarclang.calibration.spread import ERROR, LEAST_ERROR, tip_spread, touch_error
from yarclang.calibration.tool import find_tip

TIP, POINT = np.array([0.02, 0.13, 0.21]), np.array([0.9, 0.2, 0.5])


def touching(rotations, tip=TIP, point=POINT):
    """Return the flange poses (k, 4, 4) in which the tip touches the point."""
    poses = np.tile(np.eye(4), (len(rotations), 1, 1))
    poses[:, :3, :3] = rotations.as_matrix()
    poses[:, :3, 3] = point - rotations.apply(tip)
    return poses


def tilts(degrees, count):
    """Return `count` orientations tilted by `degrees`, in directions all around."""
    ways = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return Rotation.from_rotvec(
        np.radians(degrees) * np.stack((np.cos(ways), np.sin(ways), 0 * ways), axis=1)
    )


@exercises(found=0.8)
@given(
    st.integers(4, 9),
    st.integers(0, 10**6),
    st.tuples(*[st.floats(-0.5, 0.5)] * 3),
    st.tuples(*[st.floats(-3.0, 3.0)] * 3),
)
def test_the_tip_is_found_wherever_it_is(tally, count, seed, tip, point):
    poses = touching(Rotation.random(count, random_state=seed), np.array(tip), np.array(point))
    found = find_tip(poses)
    tally.count("found", found.value is not None)
    if found.value is None:  # random orientations may be too similar
        assert found.diagnostics[0].code == "Y1902"
        return
    np.testing.assert_allclose(found.value.flange_from_tip, tip, atol=1e-9)
    np.testing.assert_allclose(found.value.fixed, point, atol=1e-9)
    assert found.value.misses.max() < 1e-9
    assert not found.diagnostics


def test_touches_that_miss_are_told_with_their_number():
    poses = touching(tilts(30, 6))
    poses[4, :3, 3] += [0.0, 0.004, 0.0]
    found = find_tip(poses)
    assert found.value is not None
    assert [one.code for one in found.diagnostics] == ["Y1904"]
    assert found.value.worst == 4
    assert "touch 5" in found.diagnostics[0].message
    assert np.linalg.norm(found.value.flange_from_tip - TIP) < 0.004


@pytest.mark.parametrize("count", [4, 5, 8])
def test_95_of_100_tips_are_within_their_uncertainty(count):
    chance = np.random.default_rng(3)
    poses = touching(Rotation.concatenate([Rotation.identity(), tilts(25, count - 1)]))
    trials, inside, apart = 1000, 0, []
    for _ in range(trials):
        off = poses.copy()
        off[:, :3, 3] += chance.normal(0.0, 3e-4, (count, 3))
        found = find_tip(off).value
        assert found is not None
        spread = tip_spread(off[:, :3, :3], found.error)
        miss = found.flange_from_tip - TIP
        inside += np.sum((spread.directions @ miss / spread.axes) ** 2) <= 1.0
        # the box along the flange's axes contains the ellipsoid of directions and axes
        np.testing.assert_allclose(found.uncertainty**2, spread.axes**2 @ spread.directions**2, rtol=1e-9)
        apart.append(np.linalg.norm(miss))
    # the share may differ from 0.95 by three standard deviations for this number of trials
    assert abs(inside / trials - 0.95) <= 3.0 * np.sqrt(0.95 * 0.05 / trials)
    assert max(apart) > 1e-4


def test_touches_that_agree_better_than_an_eye_sees():
    poses = touching(tilts(30, 6))
    assert find_tip(poses).value.error == LEAST_ERROR
    assert touch_error(0.0, 0) == touch_error(0.0, 5) == ERROR, "too few residuals tell nothing good"
    assert touch_error(1e-4, 3) > ERROR, "but they tell what is bad"


@pytest.mark.parametrize("count", [0, 1, 3])
def test_too_few(count):
    found = find_tip(touching(tilts(30, 4))[:count])
    assert found.value is None
    assert found.diagnostics[0].code == "Y1901"
    assert f"{count} touches of the point, but at least 4 are needed" in found.diagnostics[0].message


def test_the_same_pose_again_tells_nothing():
    found = find_tip(touching(Rotation.from_rotvec(np.zeros((5, 3)))))
    assert [one.code for one in found.diagnostics] == ["Y1902"]


def test_turning_about_one_axis_only_leaves_the_tip_open_along_it():
    turns = Rotation.from_rotvec(np.stack([[0.0, 0.0, angle] for angle in (0, 1, 2, 3)]))
    (finding,) = find_tip(touching(turns)).diagnostics
    assert finding.code == "Y1902"
    assert "0.00 0.00 1.00" in finding.message


@pytest.mark.parametrize(("degrees", "ok"), [(5, False), (12, True)])
def test_how_far_to_tilt(degrees, ok):
    assert (find_tip(touching(tilts(degrees, 4))).value is not None) is ok
