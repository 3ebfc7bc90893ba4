"""Tests of the figures of certificates, which are rounded outwards, by comparison with exact rational
numbers.
"""

import math
from fractions import Fraction

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from yarclang.certify.certificate import (
    Blended,
    Clearance,
    Deviation,
    Load,
    ToolSpeed,
    ZoneSpeed,
    bound_text,
)
from yarclang.certify.outward import down, down_to, least, most, percent, up, up_to
from yarclang.report.distances import whole_tenths
from yarclang.report.nearest import _before_limit, _of_limit
from yarclang.units import DEG, MM

PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899")
"""Pi with more digits than a double has."""
EXACT = {MM: Fraction(1, 1000), DEG: PI / 180}
bounds = (
    st.floats(0.0, 1e4, allow_subnormal=False)
    | st.floats(1e-12, 1.0)
    | st.integers(0, 10**6).map(lambda n: n / 1e6)
)
lengths = bounds | bounds.map(lambda value: -value)
units = st.sampled_from([MM, DEG])


@given(lengths, units)
@example(0.0001, MM)
@example(0.3, MM)
@example(0.012345, DEG)
def test_another_unit_is_never_nearer_to_the_good_side(value, unit):
    true = Fraction(value) / EXACT[unit]
    above, below = most(value, unit), least(value, unit)
    assert Fraction(below) <= true <= Fraction(above)
    assert above - below <= 5 * math.ulp(above)


@given(lengths, st.integers(0, 6))
@example(0.1, 4)
@example(1e22, 4)
def test_decimals_are_outside_by_less_than_one_in_the_last_place(value, decimals):
    last = Fraction(1, 10**decimals)
    above, below = Fraction(up(value, decimals)), Fraction(down(value, decimals))
    assert below <= Fraction(value) <= above
    assert above - Fraction(value) < last
    assert Fraction(value) - below < last
    assert not up(value, decimals).startswith("-0.0000000")


@given(lengths, st.integers(1, 8))
def test_digits_are_outside_by_less_than_one_in_the_last_place(value, digits):
    above, below = Fraction(up_to(value, digits)), Fraction(down_to(value, digits))
    assert below <= Fraction(value) <= above
    if value:
        last = Fraction(10) ** (math.floor(math.log10(abs(value))) - digits + 2)
        assert above - below <= last


@given(st.floats(0.0, 30.0) | st.floats(0.999, 1.011), st.integers(0, 1))
@example(1.0, 0)
@example(1.0000000000000002, 0)
@example(0.36000000000000004, 0)
def test_percentages_bound_shares(share, decimals):
    told = Fraction(percent(share, decimals))
    assert told >= 100 * Fraction(share)
    assert told - 100 * Fraction(share) <= Fraction(1, 10**decimals)
    if share > 1.0:
        assert told > 100, "what is above its limit looks so"


def test_what_is_slightly_above_its_limit_looks_so():
    assert [percent(one) for one in (0.0, 0.5, 1.0, 1.0000000001, 1.5)] == [
        "0",
        "50",
        "100",
        "100.001",
        "150",
    ]
    assert (percent(math.inf), bound_text(math.inf, MM)) == ("unproved", "unproved")


@given(bounds, bounds, bounds, bounds)
def test_what_json_says_bounds_what_is_proved(one, two, three, four):
    said = Deviation(one, two, three, four, one, two).to_json()
    for key, value, unit in (
        ("position_mm", one, MM),
        ("angle_deg", two, DEG),
        ("end_position_mm", three, MM),
        ("end_angle_deg", four, DEG),
        ("remainder_position_mm", one, MM),
        ("remainder_angle_deg", two, DEG),
    ):
        assert Fraction(said[key]) >= Fraction(value) / EXACT[unit]
    blend = Blended(4, 0.01, 0.1, one, two).to_json()
    assert Fraction(blend["position_mm"]) >= Fraction(one) * 1000
    assert Fraction(blend["angle_deg"]) >= Fraction(two) / EXACT[DEG]
    for turns, unit, name in ((False, MM, "mm_s"), (True, DEG, "deg_s")):
        speed = ToolSpeed(turns, one, 1.0, two, three, 0.5).to_json()
        assert Fraction(speed[f"largest_{name}"]) >= Fraction(one) / EXACT[unit]
        assert Fraction(speed[f"cruise_least_{name}"]) <= Fraction(two) / EXACT[unit]
        assert Fraction(speed[f"cruise_most_{name}"]) >= Fraction(three) / EXACT[unit]
    assert Fraction(Clearance(one).to_json()["at_least_mm"]) <= Fraction(one) * 1000
    assert Fraction(ZoneSpeed(one, 1.0, "A", "B").to_json()["largest_mm_s"]) >= Fraction(one) * 1000


@given(bounds, st.floats(1e-3, 1e6))
def test_what_tables_say_bounds_what_is_proved(value, limit):
    assert Fraction(bound_text(value, MM)) >= Fraction(value) * 1000
    assert Fraction(bound_text(value, DEG)) >= Fraction(value) / EXACT[DEG]
    assert Fraction(whole_tenths(value)) <= Fraction(value) * 1000
    share = min(value, 1.0)
    used = _of_limit(Load("J1", share), limit, "deg", ".4g").split()[1]
    assert Fraction(used) >= Fraction(share) * Fraction(limit)
    used = _of_limit(Load("J1", share), limit, "counts/s", ",.0f").split()[1].replace(",", "")
    assert Fraction(used) >= Fraction(share) * Fraction(limit)
    left = _before_limit("J1", share, limit, "deg").split()[1]
    assert Fraction(left) <= (1 - Fraction(share)) * Fraction(limit)


@pytest.mark.parametrize("value", [0.0, -0.0])
def test_nothing_is_nothing(value):
    assert most(value, MM) == least(value, DEG) == 0.0
    assert bound_text(value, MM) == "0.0000"
