"""Tests of the durations of programs with loops, compared with an enumeration of all paths: the shortest one,
and the longest one with a single pass of each loop.
"""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.lasting import Lasting, known, schedule_of

BLOCKS = st.recursive(
    st.one_of(
        st.integers(1, 9).map(lambda seconds: ("time", float(seconds))),
        st.sampled_from([("wait",), ("leave",), ("anew",), ("stop",)]),
    ),
    lambda inner: st.one_of(
        st.tuples(st.just("when"), st.lists(inner, max_size=3), st.none() | st.lists(inner, max_size=3)),
        st.tuples(st.just("loop"), st.lists(inner, max_size=4)),
    ),
    max_leaves=10,
)
TREES = st.lists(BLOCKS, min_size=1, max_size=5)


def parts(block, in_loop, in_way):
    """Return a tree as a list of parts, without parts that are not allowed there or never reached."""
    found, reached = [], True
    for node in block:
        if not reached:
            break
        match node:
            case ("time", seconds):
                found.append(seconds)
            case ("wait",):
                found.append("wait")
            case ("leave",) if in_loop and in_way:
                found.append("exit")
                reached = False
            case ("anew",) if in_loop and in_way:
                found.append("next")
                reached = False
            case ("stop",) if in_way:
                found.append("finish")
                reached = False
            case ("when", first, second):
                one, goes_on = parts(first, in_loop, True)
                other, too = ([], True) if second is None else parts(second, in_loop, True)
                found += ["when", *one, *([] if second is None else ["else", *other]), "end"]
                reached = goes_on or too
            case ("loop", body):
                inner, goes_on = parts(body, True, in_way)
                found += ["loop", *inner, *(["next"] if goes_on else []), "endloop"]
                reached = "exit" in own(inner)
    return found, reached


def own(inner):
    """Return the parts of a loop's body that aren't in an inner loop."""
    depth, found = 0, []
    for part in inner:
        depth += part == "loop"
        if not depth:
            found.append(part)
        depth -= part == "endloop"
    return found


def ways(parts_, begin, end):
    """Return all paths through parts as (seconds, waits, end), where the end is "on", "exit", "next", "pass"
    or "stop"; and True if a loop may be repeated.
    """
    found = [(0.0, 0, "on")]
    loops, at = False, begin
    while at < end:
        part = parts_[at]
        if part == "when":
            middle, close = ends_of(parts_, at)
            first, more = ways(parts_, at + 1, close if middle is None else middle)
            second, too = ([(0.0, 0, "on")], False) if middle is None else ways(parts_, middle + 1, close)
            branches, loops, at = first + second, loops or more or too, close
        elif part == "loop":
            _, close = ends_of(parts_, at)
            inner, more = ways(parts_, at + 1, close)
            anew = [one for one in inner if one[2] == "next"]
            loops = loops or more or bool(anew)
            branches = [(seconds, waits, "on") for seconds, waits, how in inner if how == "exit"]
            branches += [one for one in inner if one[2] == "stop"]
            branches += [(seconds, waits, "pass") for seconds, waits, _ in anew]
            at = close
        else:
            how = {"exit": "exit", "next": "next", "finish": "stop"}.get(part, "on")
            branches = [(part if isinstance(part, float) else 0.0, int(part == "wait"), how)]
        done = [one for one in found if one[2] != "on"]
        found = done + [
            (seconds + more, waits + too, how)
            for seconds, waits, _ in (one for one in found if one[2] == "on")
            for more, too, how in branches
        ]
        at += 1
    return found, loops


def ends_of(parts_, at):
    opens, closes = ("when", "end") if parts_[at] == "when" else ("loop", "endloop")
    depth, middle = 0, None
    for number in range(at + 1, len(parts_)):
        part = parts_[number]
        if part in ("when", "loop"):
            depth += 1
        elif not depth and part == "else":
            middle = number
        elif not depth and part == closes:
            return middle, number
        elif part in ("end", "endloop"):
            depth -= 1
    raise AssertionError(opens)


@given(TREES)
def test_no_way_is_shorter_and_the_least_is_one(tree):
    made, _ = parts(tree, False, False)
    found, loops = ways(made, 0, len(made))
    told = schedule_of(made).lasting
    whole = [one for one in found if one[2] in ("on", "stop")]
    passes = [one for one in found if one[2] == "pass"]
    assert told.loops == loops
    if whole:
        assert told.least <= min(seconds for seconds, _, _ in whole)
        assert told.fewest <= min(waits for _, waits, _ in whole)
        # a path on which no loop is repeated is included in the longest time
        assert told.most >= max(seconds for seconds, _, _ in whole)
        assert told.waits >= max(waits for _, waits, _ in whole)
    if passes:
        assert told.most >= max(seconds for seconds, _, _ in passes)
    if not loops:
        assert told == Lasting(
            min(seconds for seconds, _, _ in whole),
            max(seconds for seconds, _, _ in whole),
            min(waits for _, waits, _ in whole),
            max(waits for _, waits, _ in whole),
        )


@pytest.mark.parametrize(
    ("made", "lasting"),
    [
        (["loop", 2.0, "when", "exit", "end", 3.0, "next", "endloop", 1.0], Lasting(3.0, 6.0, 0, 0, True)),
        (["loop", "when", 4.0, "wait", "next", "end", "endloop"], Lasting(0.0, 4.0, 0, 1, True)),
        ([1.0, "loop", 2.0, "next", "endloop"], Lasting(3.0, 3.0, 0, 0, True)),
        (["loop", 2.0, "exit", "endloop", 5.0], known(7.0)),
        (["ask", "else", 2.0, "end"], Lasting(0.0, 2.0, 1, 1)),
        (["loop", 2.0, "when", 9.0, "finish", "end", "when", "exit", "end", "next", "endloop"],
            Lasting(2.0, 11.0, 0, 0, True)),
    ],
)  # fmt: skip
def test_some_programs(made, lasting):
    assert schedule_of(made).lasting == lasting


def test_what_is_said_of_loops():
    assert Lasting(2.0, 6.0, 0, 2, True).text() == "2.000 to 6.000 s and 0 to 2 waits, each loop once"
    assert Lasting(3.0, 3.0, 0, 0, True).text() == "3.000 s, each loop once"
