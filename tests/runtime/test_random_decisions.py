"""Random programs with registers, branches and cases, run on the simulator with random inputs. They do step
by step what the program says.

The expected result is computed here from the drawn tree, independently of the program's text.
"""

import random

import pytest

from tests.floors import exercises
from tests.runtime.test_legs import job, world
from yarclang.runtime.notices import Remark
from yarclang.runtime.pmac.performance import perform
from yarclang.runtime.signals import OutputSet

HEAD = (
    "REGISTER N 0..6",
    "REGISTER FLAG 0..1",
    *(f"REGISTER K{depth} 0..9" for depth in range(3)),
    "INPUT JOB M70",
    "INPUT EMPTY M71",
)
PROGRAMS = 8

NUMBERS = (
    ("N + 1", lambda s: s["N"] + 1),
    ("6 - N", lambda s: 6 - s["N"]),
    ("JOB % 5", lambda s: s["JOB"] % 5),
    ("FLOOR((JOB + N) / 2)", lambda s: (s["JOB"] + s["N"]) // 2),
    ("N * FLAG", lambda s: s["N"] * s["FLAG"]),
)
CONDITIONS = (
    ("N > 2 AND NOT EMPTY = ON", lambda s: s["N"] > 2 and s["EMPTY"] != 1),
    ("JOB = N OR FLAG = 1", lambda s: s["JOB"] == s["N"] or s["FLAG"] == 1),
    ("NOT (N <= 3 OR JOB >= 4)", lambda s: not (s["N"] <= 3 or s["JOB"] >= 4)),
    ("N + FLAG <> JOB", lambda s: s["N"] + s["FLAG"] != s["JOB"]),
)
WAITS = (
    ("JOB <= 5 OR N > 2", lambda s: s["JOB"] <= 5 or s["N"] > 2),
    ("NOT (EMPTY = ON AND N > 4)", lambda s: not (s["EMPTY"] == 1 and s["N"] > 4)),
    ("JOB + N >= FLAG AND EMPTY < 2", lambda s: s["JOB"] + s["N"] >= s["FLAG"]),
)


class Ends(Exception):
    """Raised where the program ends in a branch, with a reason if it fails."""


class Leaves(Exception):
    """Raised where the innermost loop is left."""


class Returns(Exception):
    """Raised where the SUB is left."""


class Drawn:
    """Random program. Each part of it gives lines, and a function that executes the part on a state."""

    def __init__(self, chance):
        self.chance, self.index, self.marks, self.kinds = chance, 0, 0, set()
        self.in_a_way, self.in_a_loop, self.in_a_sub = 0, 0, False
        self.subs = []
        """Lines of the SUBs, which come before all other lines."""

    def number(self):
        self.index += 1
        return f"P{self.index:04d}"

    def block(self, depth):
        """Return the lines of a block, and a function of a state and a list, to which it adds the marks that
        it passes.
        """
        parts = [self.part(depth) for _ in range(self.chance.randint(1, 3) + (depth == 2))]
        lines = [line for some, _ in parts for line in some]

        def carried_out(state, passed):
            for _, does in parts:
                does(state, passed)

        return lines, carried_out

    def part(self, depth):
        still, parting = ("mark", "set"), ("when", "case", "repeat", "loop", "counted")
        kinds = (*still, *still, *still, *parting, *parting, *parting) if depth else (*still, "mark")
        kinds = (*kinds, "say", "late", "late") if self.in_a_loop else (*kinds, "wait", "say", "late", "late")
        kinds = (*kinds, "sub", "sub", "late", "late") if depth and not self.in_a_sub else kinds
        kind = "ends" if self.in_a_way and self.chance.random() < 0.12 else self.chance.choice(kinds)
        if kind == "ends" and self.in_a_loop and self.chance.random() < 0.7:
            kind = "leave"
        if kind in ("ends", "leave") and self.in_a_sub and self.chance.random() < 0.6:
            kind = "returns"
        self.kinds.add(kind)
        return getattr(self, kind)(depth)

    def mark(self, _):
        """Return a motion there and back, followed by an output that shows that the place was passed."""
        self.marks += 1
        mark, angle = self.marks, self.chance.randint(1, 9)
        lines = [
            f"{self.number()} MOVEJ {angle} 0 0 0 0 0 [MIN] (deg)",
            f"{self.number()} MOVEJ HOME [MIN]",
            f"{self.number()} SET LAMP {mark}",
        ]
        return lines, lambda state, passed: passed.append(mark)

    def set(self, _):
        name = self.chance.choice(("N", "N", "FLAG"))
        text, value = self.chance.choice(NUMBERS)
        high = 6 if name == "N" else 1
        if self.chance.random() < 0.9:
            whole, text = value, f"({text}) % {high + 1}"
            value = lambda state: whole(state) % (high + 1)  # noqa: E731

        def carried_out(state, passed):
            number = value(state)
            if not 0 <= number <= high:
                raise OverflowError
            state[name] = number

        return [f"{self.number()} SET {name} = {text}"], carried_out

    def ends(self, _):
        """Return lines that end the program in a branch, successfully or with a reason."""
        angle = self.chance.randint(1, 9)
        before, last = self.number(), self.number()
        reason = f"because of {last}" if self.chance.random() < 0.5 else ""
        lines = [
            f"{before} MOVEJ {angle} 0 0 0 0 0 [MIN] (deg)",
            f'{last} ABORT "{reason}"' if reason else f"{last} STOP",
        ]

        def carried_out(state, passed):
            raise Ends(reason)

        return lines, carried_out

    def say(self, _):
        """Return a SAY with the value of a register."""

        def carried_out(state, passed):
            state["said"].append(f"N is {state['N']}")

        return [f'{self.number()} SAY "N is {{N}}"'], carried_out

    def wait(self, _):
        """Return a WAIT. Inputs don't change here, so its condition holds at once or never."""
        text, holds = self.chance.choice(WAITS)

        def carried_out(state, passed):
            if not holds(state):
                raise Ends("has waited 0.1 s")

        return [f"{self.number()} WAIT {text} [0.1] (s)"], carried_out

    def late(self, _):
        """Return a WAIT with ELSE, whose condition holds at once or never."""
        text, holds = self.chance.choice(WAITS)
        self.marks += 1
        mark = self.marks
        lines = [f"{self.number()} WAIT {text} [0.1] (s) ELSE", f"{self.number()} SET LAMP {mark}", "END"]

        def carried_out(state, passed):
            if not holds(state):
                passed.append(mark)
                state["late"] += 1

        return lines, carried_out

    def way(self, depth):
        self.in_a_way += 1
        found = self.block(depth)
        self.in_a_way -= 1
        return found

    def when(self, depth):
        text, holds = self.chance.choice(CONDITIONS)
        first, second = self.way(depth - 1), self.way(depth - 1)

        def carried_out(state, passed):
            (first if holds(state) else second)[1](state, passed)

        return [f"WHEN {text}", *first[0], "ELSE", *second[0], "END"], carried_out

    def repeat(self, depth):
        lines, does = self.block(depth - 1)

        def carried_out(state, passed):
            does(state, passed)
            does(state, passed)

        return ["REPEAT 2", *lines, "END"], carried_out

    def leave(self, _):
        def carried_out(state, passed):
            raise Leaves

        return [f"{self.number()} EXIT"], carried_out

    def returns(self, _):
        def carried_out(state, passed):
            raise Returns

        return [f"{self.number()} RETURN"], carried_out

    def sub(self, depth):
        """Return a call of a new SUB. A RETURN may be in the SUB's branches, and in the branches of its
        loops.
        """
        around, self.in_a_way, self.in_a_loop, self.in_a_sub = (self.in_a_way, self.in_a_loop), 0, 0, True
        lines, does = self.block(depth)
        (self.in_a_way, self.in_a_loop), self.in_a_sub = around, False
        name = f"S{len(self.subs)}"
        self.subs.append([f"SUB {name}", *lines, "END"])

        def carried_out(state, passed):
            try:
                does(state, passed)
            except Returns:
                state["returned"] += 1

        return [f"{self.number()} CALL {name}"], carried_out

    def body(self, depth):
        """Return the lines of a loop. EXIT and STOP may be only in branches within this loop."""
        around, self.in_a_way = self.in_a_way, 0
        self.in_a_loop += 1
        found = self.block(depth)
        self.in_a_loop -= 1
        self.in_a_way = around
        return found

    def counted(self, depth):
        """Return a loop with as many passes as a register says before it."""
        lines, does = self.body(depth - 1)

        def carried_out(state, passed):
            try:
                for _ in range(state["N"]):
                    does(state, passed)
                    state["passes"] += 1
            except Leaves:
                state["left"] += 1

        return ["REPEAT N", *lines, "END"], carried_out

    def loop(self, depth):
        """Return a LOOP or WHILE with at most a few passes."""
        name, most = f"K{depth}", self.chance.randint(1, 3)
        text, holds = self.chance.choice(CONDITIONS)
        is_while = self.chance.random() < 0.5
        before, counts = self.number(), self.number()
        lines, does = self.body(depth - 1)

        def carried_out(state, passed):
            state[name] = 0
            try:
                while not is_while or (state[name] < most and holds(state)):
                    state[name] += 1
                    does(state, passed)
                    if not is_while and (state[name] >= most or holds(state)):
                        break
                    state["passes"] += 1
            except Leaves:
                state["left"] += 1

        count = f"{counts} SET {name} = {name} + 1"
        if is_while:
            looped = [f"WHILE {name} < {most} AND ({text})", count, *lines, "END"]
        else:
            looped = ["LOOP", count, *lines, f"UNTIL {name} >= {most} OR ({text})"]
        return [f"{before} SET {name} = 0", *looped], carried_out

    def case(self, depth):
        selector = self.chance.choice(("N", "JOB"))
        bounds = [(0, 1), (2, 2), (3, 5)]
        ways = [self.way(depth - 1) for _ in (*bounds, "else")]
        lines = [f"CASE {selector}"]
        for (low, high), way in zip(bounds, ways, strict=False):
            lines += [f"OF {low}..{high}" if low < high else f"OF {low}", *way[0]]
        lines += ["ELSE", *ways[-1][0], "END"]

        def carried_out(state, passed):
            number = state[selector]
            way = next((w for (a, b), w in zip(bounds, ways, strict=False) if a <= number <= b), ways[-1])
            way[1](state, passed)

        return lines, carried_out


@pytest.fixture
def robot(industrial6):
    return industrial6


@exercises(
    whole=0.3,
    ends=0.05,
    when=0.4,
    case=0.4,
    repeat=0.3,
    stop=0.01,
    abort=0.01,
    waits=0.1,
    say=0.1,
    group=0.2,
    passes=0.08,
    left=0.02,
    late=0.04,
    returned=0.01,
)
def test_what_is_done_is_what_the_program_says(tally, robot):
    for seed in range(PROGRAMS):
        chance = random.Random(f"{seed}-{tally.drawn['whole']}")
        program = Drawn(chance)
        lines, carried_out = program.block(2)
        is_group = chance.random() < 0.5
        head = [line.replace("JOB M70", "JOB M72..M74") if is_group else line for line in HEAD]
        run = job(robot, *head, *(line for one in program.subs for line in one), *lines)
        for _ in range(2):
            counters = dict.fromkeys(("K0", "K1", "K2", "passes", "left", "late", "returned"), 0)
            state = {
                "N": 0,
                "FLAG": 0,
                **counters,
                "JOB": chance.randint(0, 6),
                "EMPTY": chance.randint(0, 1),
            }
            passed, state["said"] = [], []
            made = world(robot)
            values = {"M70": state["JOB"], "M71": state["EMPTY"]}
            values |= {f"M{72 + bit}": state["JOB"] >> bit & 1 for bit in range(3)}
            for variable, number in values.items():
                made.machine.command(f"{variable}->*", 7)
                made.machine.command(f"{variable}={number}", 7)
            ended = made.perform(perform(made.operation, run))
            stops, reason = False, ""
            try:
                carried_out(state, passed)
                is_whole = True
            except OverflowError:
                is_whole = False
            except Ends as end:
                stops, reason = True, str(end)
                is_whole = not reason
            told = [one.value for one in made.told if isinstance(one, OutputSet) and one.variable == "M2"]
            assert told == passed, (seed, lines)
            remarks = [one.text for one in made.told if isinstance(one, Remark)]
            assert [one.partition("SAY: ")[2] for one in remarks if "SAY: " in one] == state["said"]
            tally.count("say", bool(state["said"]))
            assert ended.well == is_whole, (seed, ended.what, lines)
            assert is_whole or ended.code == (
                "Y1604" if "waited" in reason else "Y1635" if reason else "Y1630"
            )
            assert reason in ended.what
            tally.count("stop", stops and not reason)
            tally.count("abort", "because" in reason)
            tally.count("waits", "wait" in program.kinds and "waited" not in reason)
            tally.count("passes", state["passes"] > 1)
            tally.count("left", state["left"])
            tally.count("late", state["late"])
            tally.count("returned", state["returned"])
            held = dict(ended.registers or (("N", 0), ("FLAG", 0)))
            assert {name: held[name] for name in ("N", "FLAG")} == {
                "N": state["N"],
                "FLAG": state["FLAG"],
            }
            tally.count("whole", is_whole and len(passed) > 1)
            tally.count("ends", not is_whole)
            tally.count("group", is_group and "JOB" in " ".join(lines))
            tally.count("when", "when" in program.kinds)
            tally.count("case", "case" in program.kinds)
            tally.count("repeat", "repeat" in program.kinds)
