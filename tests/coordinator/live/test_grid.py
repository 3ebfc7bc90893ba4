"""Tests of the control points of live motions. For all inputs they respect the limits, reach the requested
velocity, and can come to rest.
"""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from yarclang.coordinator.live.grid import Rates, State, advance, to_rest

RATES = Rates(np.array([1.0, 0.5, 2.0]), np.array([4.0, 3.0, 8.0]), np.array([35.0, 20.0, 60.0]))
H = 0.01
WANTED = st.lists(
    st.tuples(st.integers(1, 40), st.lists(st.floats(-3.0, 3.0), min_size=3, max_size=3)),
    min_size=1,
    max_size=6,
)


def driven(changes):
    state = State.at_rest(np.zeros(3))
    states = [state]
    for count, wanted in changes:
        for _ in range(count):
            state = advance(state, np.array(wanted), RATES, H)
            states.append(state)
    return states


@settings(max_examples=150, deadline=None)
@given(WANTED)
@example([(2, [0.0, 0.0, 1.0]), (29, [0.0, 1.0, 2.0]), (4, [1.0, 0.0, 0.0])])
def test_limits_hold_on_the_grid_whatever_is_wanted(changes):
    states = driven(changes)
    states += to_rest(states[-1], RATES, H)
    c = np.array([states[0].c, states[0].c, *(one.c for one in states), states[-1].c, states[-1].c])
    v = np.diff(c, axis=0) / H
    a = np.diff(v, axis=0) / H
    j = np.diff(a, axis=0) / H
    assert (np.abs(v) <= RATES.velocity + 1e-9).all()
    assert (np.abs(a) <= RATES.acceleration + 1e-6).all()
    assert (np.abs(j) <= RATES.jerk * (1.0 + 1e-6) + 1e-4).all()


@settings(max_examples=150, deadline=None)
@given(WANTED)
def test_rest_is_always_reached_and_soon(changes):
    states = driven(changes)
    rest = to_rest(states[-1], RATES, H)
    assert (rest or states)[-1].rests
    # Upper bound: the slowest joint brakes from its largest speed, with its largest acceleration in the wrong
    # direction at first. Twice this time is allowed.
    longest = 2.0 * (RATES.velocity / RATES.acceleration + 2.0 * RATES.acceleration / RATES.jerk).max()
    assert len(rest) * H <= longest


@settings(max_examples=100, deadline=None)
@given(st.lists(st.floats(-3.0, 3.0), min_size=3, max_size=3))
def test_from_rest_the_way_keeps_its_direction_and_nothing_is_overshot(wanted):
    wanted = np.array(wanted)
    states = driven([(150, wanted)])
    aim = np.clip(wanted, -RATES.velocity, RATES.velocity)
    v = np.array([one.v for one in states])
    assert np.abs(v[-1] - aim).max() < 1e-6
    assert (np.abs(v) <= np.abs(aim) + 1e-7).all()
    if np.linalg.norm(aim) > 0.1:
        share = v @ aim / (aim @ aim)
        assert np.abs(v - share[:, None] * aim).max() < 1e-5
