"""The second terminal's session in docs/runtime.md, executed beside a run.

Its output is compared without numbers, which differ each time. `pytest tests/cli/test_run_page.py
--rewrite-golden` writes the present output into the page.
"""

import re
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = DOCS / "runtime.md"
_PROGRAM = re.compile(r"^```yarc\n(! bend\.yarc\n.*?)^```$", re.DOTALL | re.MULTILINE)
_SECOND = re.compile(r"^```console second\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def shape(text):
    """Return a text without the numbers and times that differ each time."""
    text = re.sub(r"\d{4}-\d\d-\d\dT[\d:+-]+", "WHEN", text)
    return re.sub(r"-?\d+(\.\d+)?", "N", text)


def test_second_terminal(workshop, rewrite_golden):
    text = PAGE.read_text(encoding="utf-8")
    ((program),) = _PROGRAM.findall((DOCS / "tour.md").read_text(encoding="utf-8"))
    ((session),) = _SECOND.findall(text)
    workshop.write("bend.yarc", program)
    run = workshop.start("run", "bend.yarc", "--rate", "2", "--no-log")
    run.wait_for("P0030")
    commands = [line[2:] for line in session.splitlines() if line.startswith("$ yarc ")]
    now = "".join(f"$ {command}\n{workshop.here(*command.split()[1:])}" for command in commands)
    run.kill()  # the rest of the run isn't needed
    if rewrite_golden and shape(session) != shape(now):
        PAGE.write_text(_SECOND.sub(lambda _: f"```console second\n{now}```", text), encoding="utf-8")
        session = now
    assert shape(session) == shape(now)
