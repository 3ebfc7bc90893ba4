"""`yarc verify`."""

from __future__ import annotations

from pathlib import Path

import click

from yarclang.cli.options import file_argument


@click.command("verify")
@file_argument("text", metavar="NAME.pmc")
@file_argument("proof", metavar="[NAME.proof.json]", required=False)
def command(text: str, proof: str | None) -> None:
    """Check a text by the proof that `yarcc --proof` has written beside it, with a checker of its own that can be read in an afternoon: standard library, integers and fractions.

    It tells what was checked, what wasn't, and which robot and program the proof tells of. The status is 0 if all was checked, 1 if the text or its proof was refused, 3 if nothing
    is wrong in what was checked and something wasn't checked.
    """
    from yarclang.verify.__main__ import main

    raise SystemExit(main([text, proof or str(Path(text).with_suffix(".proof.json"))]))
