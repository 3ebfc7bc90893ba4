"""Tests that each peak is a bound of the exact motion of the printed numbers, by comparison
with fractions.
"""

from fractions import Fraction

import numpy as np
import pytest

from yarclang.certify.motion.bounds import Cubics
from yarclang.units import DEG, MM, MS

PIECES = 1250
TIMES = ("0.732421875", "1.3", "5", "12.207", "50")
AT = ("start", "middle", "end")


def _texts(rng, kind, count):
    """Return random control points of a kind of motion, as printed in a text [deg or mm]."""
    decimals = int(rng.integers(3, 10))
    steps = {
        "slow": 10.0 ** rng.uniform(-9, -2, (count, 1)) * rng.normal(size=(count, 3)),
        "quick": rng.normal(size=(count, 3)),
        "at rest": np.where(rng.random((count, 3)) < 0.7, 0.0, rng.normal(size=(count, 3)) * 1e-3),
        "turning back": np.stack([rng.random(count), -rng.random(count), rng.random(count)], axis=1),
    }[kind]
    starts = rng.uniform(-1, 1, count) * 10.0 ** rng.uniform(-3, 3.5, count)
    points = np.concatenate([starts[:, None], starts[:, None] + np.cumsum(steps, axis=1)], axis=1)
    return [[f"{value:.{decimals}f}" for value in row] for row in points.tolist()]


def _exact(texts, time, unit):
    """Return the exact position, velocity and acceleration at the start, the jerk, and the segment time."""
    f0, f1, f2, f3 = (Fraction(text) * Fraction(unit) for text in texts)
    h = Fraction(time) / 1000
    x = (f0 + 4 * f1 + f2) / 6
    return x, (f2 - f0) / (2 * h), (f0 - 2 * f1 + f2) / h**2, (f3 - 3 * f2 + 3 * f1 - f0) / h**3, h


def _peaks(x, v, a, j, h):
    """Return the exact peaks of velocity and acceleration, and the smallest and largest of some positions
    that are reached.
    """
    times = [Fraction(0), h]
    speeds = [abs(v), abs(v + a * h + j * h * h / 2)]
    if j and 0 < -a / j < h:
        speeds.append(abs(v - a * a / (2 * j)))
    # The times of zero velocity may be approximate, because the position at any time of the segment is one
    # that the motion reaches.
    under = a * a - 2 * j * v
    if under >= 0:
        root = Fraction(float(under) ** 0.5)
        for sign in (1, -1):
            if j:
                times.append((-a + sign * root) / j)
            divisor = -a + sign * root
            if divisor:
                times.append(2 * v / divisor)
    positions = [x + t * (v + t * (a / 2 + t * j / 6)) for t in times if 0 <= t <= h]
    return max(speeds), max(abs(a), abs(a + j * h)), min(positions), max(positions)


@pytest.mark.parametrize("kind", ["slow", "quick", "at rest", "turning back"])
def test_peaks_are_bounds_of_the_exact_motion(kind):
    rng = np.random.default_rng(len(kind))
    worst = 0.0
    for time in TIMES:
        count = PIECES // len(TIMES)
        for unit in (DEG, MM):
            texts = _texts(rng, kind, count // 2)
            control = np.array([[float(text) for text in row] for row in texts]).ravel()[:, None] * unit
            h = np.full(len(texts), float(time) * MS)
            cubics = Cubics.of_spline(control, 4 * np.arange(len(texts)), h)
            low, high = cubics.position_range()
            found = [cubics.velocity_peaks(), cubics.acceleration_peaks(), cubics.jerk_peaks(), low, high]
            for row, text in enumerate(texts):
                exact = _exact(text, time, unit)
                speed, strength, least, most = _peaks(*exact)
                velocity, acceleration, jerk, lower, upper = (Fraction(float(one[row, 0])) for one in found)
                assert velocity >= speed
                assert acceleration >= strength
                assert jerk >= abs(exact[3])
                assert lower <= least
                assert upper >= most
                # The bounds aren't far above: 1e-6 deg/s^3 with segments of 1.3 ms.
                size = max(abs(float(one)) for one in text) * unit
                worst = max(worst, float(velocity - speed) * h[0] / max(size, 1e-9))
    assert worst < 1e-13


@pytest.mark.parametrize("kind", ["quick", "turning back"])
def test_motors_are_bounded_exactly(kind):
    rng = np.random.default_rng(3)
    matrix = np.array([[25532.8278, 0.0, 300.5], [0.0, -1e5, 29308.7083], [1e-3, 1.0, 7.0]])
    for time in TIMES:
        texts = [_texts(rng, kind, 3) for _ in range(20)]
        control = np.array([[[float(text) for text in row] for row in joints] for joints in texts]) * DEG
        control = control.transpose(0, 2, 1).reshape(-1, 3)
        cubics = Cubics.of_spline(control, 4 * np.arange(20), np.full(20, float(time) * MS)).mapped(matrix)
        peaks = cubics.velocity_peaks()
        for row, joints in enumerate(texts):
            parts = [_exact(text, time, DEG) for text in joints]
            for motor in range(3):
                weights = [Fraction(float(one)) for one in matrix[motor]]
                x, v, a, j = (
                    sum(w * part[k] for w, part in zip(weights, parts, strict=True)) for k in range(4)
                )
                speed, *_ = _peaks(x, v, a, j, parts[0][4])
                assert Fraction(float(peaks[row, motor])) >= speed


def test_rounding_to_nearest_would_fall_short():
    """The test would notice an error: with rounding to nearest, many jerks are too small."""
    rng = np.random.default_rng(1)
    texts = _texts(rng, "slow", 200)
    control = np.array([[float(text) for text in row] for row in texts]).ravel()[:, None] * DEG
    cubics = Cubics.of_spline(control, 4 * np.arange(200), np.full(200, 1.3 * MS))
    short = [
        Fraction(float(abs(cubics.j[row, 0]))) < abs(_exact(text, "1.3", DEG)[3])
        for row, text in enumerate(texts)
    ]
    assert sum(short) > 40
