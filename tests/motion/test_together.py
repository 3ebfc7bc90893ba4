"""Test that motions planned together equal those planned one by one."""

from random import Random

import pytest
from programs import codes, planned

from yarclang.motion import runs
from yarclang.motion.leading import ahead, reached

OPENING = "DEFAULT {TCP} (mm,deg,s) {B}\nP0001 MOVEJ_RPY_LSPB 0 1174.4 1176 0 0 0 [3]\n"
FAR, NEAR = 60.0, 3.0
TIMES = [
    ("LSPB", "[1]", FAR),
    ("LSPB", "[1] ACC 80%", FAR),
    ("POLY5", "[1.2]", FAR),
    ("SCURVE", "[1.5]", FAR),
    ("LSPB", "[MIN]", FAR),
    ("SCURVE", "[MIN]", NEAR),
    ("LSPB", "[V 50]", NEAR),
    ("LSPB", "[V 50]", FAR),
    ("LSPB", "[0.11]", NEAR),
]


def line(random, number, law, time, reach):
    x, y, z = (middle + random.uniform(-reach, reach) for middle in (0.0, 1174.4, 1176.0))
    turns = " ".join(f"{random.uniform(-3, 3) * reach / FAR:.3f}" for _ in range(3))
    return f"P{number:04d} MOVEL_RPY_{law} {x:.3f} {y:.3f} {z:.3f} {turns} {time}\n"


def program(seed, *, all_alike=False):
    random = Random(seed)
    rows, kind = [OPENING], random.choice(TIMES)
    for number in range(2, 26):
        if not all_alike and random.random() < 0.2:
            kind = random.choice(TIMES)
        rows.append(line(random, number, *kind))
        if not all_alike and random.random() < 0.1:
            rows.append(f"P{900 + number:04d} DMOVEJ 0.5 0 0 0 0 0 [1]\n")
    return "".join(rows)


@pytest.mark.parametrize("seed", range(8))
def test_each_motion_is_what_it_is_alone(seed, monkeypatch):
    text = program(seed)
    together, found = planned(text)
    monkeypatch.setattr(runs, "MOST", 1)
    alone, found_alone = planned(text)
    assert [(one.code, one.message, one.span) for one in found] == [
        (one.code, one.message, one.span) for one in found_alone
    ]
    assert (together is None) == (alone is None)
    if together is None:
        assert {"Y0601", "Y0605"} & set(codes(found))
        return
    for one, other in zip(together.motions, alone.motions, strict=True):
        assert one.curve.segment == other.curve.segment
        assert one.curve.points == pytest.approx(other.curve.points, abs=1e-12)
        assert one.law == pytest.approx(other.law, abs=1e-12)


def test_one_motion_after_the_other_is_worked_out_in_growing_runs():
    growing, sizes, number = runs.Growing(), [], 0
    for _ in range(9):
        size = growing.size(number)
        sizes.append(size)
        number += size
        growing.done(number - 1)
    assert sizes == [1, 2, 4, 8, 16, 32, 64, 64, 64]
    assert growing.size(3) == 1


def chain(seed):
    """Return a long chain of short lines and arcs. In every second program, they have rotations."""
    random = Random(seed)
    x, y, z, turn = 40.0, 1000.0, 1000.0, 0.0
    rows = ["DEFAULT {TCP} [V 20] (mm,deg,s) {B}\n", f"P0001 MOVEJ_RPY {x} {y} {z} 0 0 0 [3]\n"]
    for number in range(2, 62):
        before = x, y
        x, y = x + random.uniform(0.5, 3.0), y + random.uniform(-0.3, 0.3)
        turn += random.uniform(-0.3, 0.3) if seed % 2 else 0.0
        pose = f"{x:.3f} {y:.3f} {z:.3f} {turn:.3f} 0 0" + (" BLEND 0.3" if number < 61 else "")
        if random.random() < 0.3:
            via = f"{(before[0] + x) / 2:.3f} {(before[1] + y) / 2 + 0.05:.3f} {z:.3f}"
            rows.append(f"P{number:04d} MOVEC {via}; {pose}\n")
        else:
            rows.append(f"P{number:04d} MOVEL {pose}\n")
    return "".join(rows)


@pytest.mark.parametrize("seed", range(4))
def test_the_ways_of_a_long_chain_are_what_each_is_alone(seed, monkeypatch):
    text = chain(seed)
    together, _ = planned(text)
    monkeypatch.setattr(ahead, "MOST_IN_CHAINS", 1)
    alone, _ = planned(text)
    assert together is not None
    assert alone is not None
    for one, other in zip(together.motions, alone.motions, strict=True):
        assert one.path.start.tolist() == other.path.start.tolist()
        assert one.path.end.tolist() == other.path.end.tolist()
        assert one.curve.points.tolist() == other.curve.points.tolist()


@pytest.mark.parametrize("seed", range(2))
def test_faults_behind_a_fault_are_found_as_each_alone(seed, monkeypatch):
    rows = chain(seed).splitlines(keepends=True)
    rows[5] = rows[5].replace("MOVE", "MOFE")
    rows[20] = rows[20].replace("1000.000", "2500.000")
    rows[40] = "P0900 DMOVE 0 0 5 0 0 0 BLEND 0.3\n"
    text = "".join(rows)
    _, found = planned(text)
    monkeypatch.setattr(reached, "MOST_POSES", 1)
    _, found_alone = planned(text)
    assert {"Y0202", "Y0501"} <= set(codes(found))
    assert [(one.code, one.message, one.span) for one in found] == [
        (one.code, one.message, one.span) for one in found_alone
    ]
