"""Property: a program whose commands are typed one by one leaves the parts in the same places as the program
as a whole.
"""

from pathlib import Path

import numpy as np
from floors import exercises
from handling.carrying import CELL, GIVEN, HEAD
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from yarclang.coordinator.kept_parts import KeptParts, Performed
from yarclang.coordinator.lines import Lines
from yarclang.coordinator.offers import Planner
from yarclang.handling.parts import first_parts
from yarclang.pipeline.inputs import Options, open_source
from yarclang.pipeline.stages import compile_module
from yarclang.runtime.outcome import Ended
from yarclang.source import SourceFile

VISITS = st.tuples(
    st.sampled_from(["FEEDER", "PUT"]), st.sampled_from(["GRIP ON", "GRIP OFF", "GRIP ON", "TAKEN ON", ""])
)
THERE_AND_BACK = [("FEEDER", "GRIP ON"), ("PUT", "GRIP OFF"), ("PUT", "GRIP ON"), ("FEEDER", "GRIP OFF")]
EMPTY = st.tuples(st.just("PUT"), st.sampled_from(["", "GRIP OFF", "TAKEN ON"]))
"""A visit of a place that changes nothing while the box is in the feeder."""


def carried(before, after):
    """Return a strategy of visits that carry the box to PUT and back to the feeder, or a part of this way."""
    return st.builds(
        lambda first, count, then: [*first, *THERE_AND_BACK[:count], *then],
        st.lists(EMPTY, max_size=before),
        st.integers(1, 4),
        st.lists(VISITS, max_size=after),
    )


SERIES = st.one_of(carried(1, 0), carried(2, 0), carried(0, 1), st.lists(VISITS, min_size=1, max_size=4))
"""Sequences of visits that can mostly be carried out, and random sequences, which rarely can."""


def commands(visits):
    text = ["MOVEJ READY"]
    for place, output in visits:
        text += [f"MOVEJ_RPY 0 0 120 0 0 0 {{{place}}}", f"MOVEL 0 0 0 0 0 0 [1.2] {{{place}}}"]
        text += [f"SET {output}"] if output else []
        text += [f"MOVEL 0 0 120 0 0 0 [1.2] {{{place}}}"]
    return [*text, "MOVEJ READY"]


def whole(folder, text):
    """Compile a program. Return the final places of its parts; None if the program is refused."""
    body = "".join(f"P{10 * number:04d} {one}\n" for number, one in enumerate(text, 1))
    opened = open_source(
        SourceFile(str(folder / "p.yarc"), HEAD + body), folder, Options(robot="INDUSTRIAL6")
    )
    compiled = compile_module(opened.value.module, opened.value.request).value
    if compiled is None:
        return None
    return learned(KeptParts(compiled.plan.robot), compiled)


def learned(kept, compiled):
    """Record that a program was carried out to its end."""
    from yarclang.pipeline.jobs import job_of_compiled

    plan, job = compiled.plan, job_of_compiled(compiled, "p")
    cell = plan.program.cell
    what = Performed(plan, 0, len(plan.program.steps), job, first_parts(cell))
    kept.performed(what, Ended(True, joints=job.end), {})
    return kept.known(cell).present.parts


def typed(folder, text):
    """Enter the commands one by one. Return the final places of the parts."""
    (folder / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    from yarclang.robot.description import load_robot

    robot = load_robot("INDUSTRIAL6").value
    kept, lines, parts = KeptParts(robot), Lines(), None
    planner = Planner(robot, folder, present=kept.now_for_lines)
    lines.declare(("DEFAULT {GRIPPER} [50%] (mm,deg,s) {B}",))
    start = robot.home
    for number, one in enumerate(text):
        made = planner.offer(one, lines, start, number)
        assert made.value is not None, (one, [each.message for each in made.diagnostics])
        parts = learned(kept, made.value.compiled)
        start = made.value.end
    return parts


def places(parts):
    return sorted((one.name, one.gripper or "", one.is_sure) for one in parts.items), {
        one.name: one.transform for one in parts.items
    }


@exercises(moved=0.4, certified=0.4)
@settings(max_examples=8, deadline=None, suppress_health_check=list(HealthCheck))
@given(visits=SERIES, count=st.integers(1, 2))
@example(
    visits=[("FEEDER", "GRIP ON"), ("PUT", "GRIP OFF"), ("PUT", "TAKEN ON"), ("FEEDER", "GRIP ON")], count=2
)
@example(
    visits=[("FEEDER", "GRIP ON"), ("PUT", "GRIP OFF"), ("PUT", "GRIP ON"), ("FEEDER", "GRIP OFF")], count=1
)
def test_lines_leave_the_parts_as_the_program(tmp_path_factory, tally, visits, count):
    folder = Path(tmp_path_factory.mktemp("lines"))
    (folder / "cell.toml").write_text(CELL.format(**{**GIVEN, "count": count}))
    text = commands(visits)
    meant = whole(folder, text)
    tally.count("certified", meant is not None)
    if meant is None:
        return
    found = typed(folder, text)
    (names, poses), (others, other) = places(meant), places(found)
    assert names == others
    assert meant.closed == found.closed
    assert not meant.expected
    assert not found.expected
    for name, pose in poses.items():
        assert np.allclose(pose, other[name], rtol=0.0, atol=1e-5), name
    tally.count("moved", any(visit[1].startswith("GRIP") for visit in visits))
