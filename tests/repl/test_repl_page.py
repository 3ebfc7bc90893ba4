"""Tests of docs/repl.md: its lines are typed, and the output is the one on the page."""

import asyncio
import re
from pathlib import Path

import click
import pytest
from coordinator.virtual import run
from repl.talking import talking

PAGE = Path(__file__).parents[2] / "docs" / "repl.md"
BLOCK = re.compile(r"(?<=```console\n).*?(?=```)", re.DOTALL)
TYPED = re.compile(r"(yarc> |  \.\.\. |go\? \[y/N\] |.*\? \[y/N\] |\((\d+) s later\) )(.*)")
CTRL_C = "^C"
SHORT = 0.05


def replayed(block, folder):
    """Return the typed lines of a block, with the present output."""

    async def session():
        async with talking(folder, asks=True) as person:
            shown, pending = [], ""
            lines = [found for line in block.splitlines() if (found := TYPED.fullmatch(line))]
            for at, found in enumerate(lines):
                shown.append(found[0] if not person.asked else f"{person.asked}{found[3]}")
                if found[3] == CTRL_C:
                    person.interpreter.interrupt()
                else:
                    pending += f"{found[3]}\n"
                    if at + 1 < len(lines) and lines[at + 1][1] == "  ... ":
                        continue
                    person.interpreter.typed(pending.rstrip("\n"))
                    pending = ""
                if at + 1 < len(lines) and lines[at + 1][3] == CTRL_C:
                    await asyncio.sleep(float(lines[at + 1][2]))
                else:
                    await person.settled()
                    await asyncio.sleep(SHORT)  # waits for the output of events
                told = click.unstyle(person.taken()).replace(f"{folder}/", "")
                shown += told.splitlines()
            return "\n".join(shown) + "\n"

    return run(session())


def test_the_page_is_what_is_said(tmp_path, request):
    old = PAGE.read_text(encoding="utf-8")
    new = BLOCK.sub(lambda found: replayed(found[0], tmp_path), old)
    if request.config.getoption("--rewrite-golden"):
        PAGE.write_text(new, encoding="utf-8")
    elif new != old:
        pytest.fail(
            "docs/repl.md isn't what yarc repl says: run with --rewrite-golden, and read the difference"
        )


def test_no_line_of_the_page_fails_in_a_way_that_is_not_meant():
    said = "".join(BLOCK.findall(PAGE.read_text(encoding="utf-8")))
    assert "Traceback" not in said
    assert set(re.findall(r"error (Y\d{4})", said)) == {"Y0202", "Y0601"}
