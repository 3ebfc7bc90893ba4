"""Tests of lines of the moving frame: many lines at once equal each single one, to the last bit."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from yarclang.motion.paths.line import line_between, lines_between, poses_along


def pairs(random, size):
    """Return poses (12, 4, 4) at which lines begin and end, rotated by about `size` [rad]. One line stands
    still, another one rotates by half a turn.
    """
    starts, ends = np.tile(np.eye(4), (2, 12, 1, 1))
    starts[:, :3, :3] = Rotation.random(12, random_state=random).as_matrix()
    ends[:, :3, :3] = Rotation.from_rotvec(random.normal(size=(12, 3)) * size).as_matrix() @ starts[:, :3, :3]
    ends[3] = starts[3]
    ends[5, :3, :3] = np.diag([-1.0, -1.0, 1.0]) @ starts[5, :3, :3]
    starts[:, :3, 3] = random.normal(size=(12, 3))
    ends[:, :3, 3] = starts[:, :3, 3] + random.normal(size=(12, 3)) * size
    return starts, ends


@pytest.mark.parametrize("size", [1e-12, 1e-9, 1e-5, 0.01, 1.0])
def test_many_lines_are_what_each_is_alone(size):
    starts, ends = pairs(np.random.default_rng(1), size)
    places = np.array([0.0, 0.1, 1.0 / 3.0, 0.9, 1.0])
    together = lines_between(starts, list(ends))
    alone = [line_between(start, end) for start, end in zip(starts, ends, strict=True)]
    assert [one is None for one in together] == [one is None for one in alone]
    assert alone[5] is None
    for one, other in zip(together, alone, strict=True):
        if one is not None:
            assert (one.angle, one.length) == (other.angle, other.length)
            assert one.shift.tobytes() == other.shift.tobytes()
            assert one.axis.tobytes() == other.axis.tobytes()
    whole = [one for one in alone if one is not None]
    for poses, line in zip(poses_along(whole, places), whole, strict=True):
        assert poses.tobytes() == line.poses(places).tobytes()
        assert poses[-1].tobytes() == line.base_from_end.tobytes()
