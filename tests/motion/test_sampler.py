"""Test that many curves sampled together give the same values as each one alone."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.motion.curve import Curve, Sampler

CURVES = st.lists(
    st.tuples(st.integers(4, 9), st.floats(0.002, 0.05), st.integers(0, 2**31)), min_size=1, max_size=6
)


@settings(max_examples=60, deadline=None)
@given(CURVES, st.lists(st.tuples(st.integers(0, 5), st.floats(-0.1, 0.6)), min_size=1, max_size=30))
def test_many_curves_are_sampled_to_the_last_bit_as_one(made, asked):
    curves = [
        Curve(np.random.default_rng(seed).normal(size=(rows, 3)), segment, np.zeros(rows))
        for rows, segment, seed in made
    ]
    number = np.array([one % len(curves) for one, _ in asked])
    times = np.array([time for _, time in asked])
    together = Sampler(curves).sample(number, times)
    for row, (curve, time) in enumerate(zip(number, times, strict=True)):
        alone = curves[curve].sample(np.array([time]))
        for mine, its in zip(together, alone, strict=True):
            assert mine[row].tobytes() == its[0].tobytes()
