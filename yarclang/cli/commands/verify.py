"""`yarc verify`."""

from __future__ import annotations

from pathlib import Path

import click

from yarclang.cli.options import file_argument


@click.command("verify")
@file_argument("text", metavar="NAME.pmc")
@file_argument("proof", metavar="[NAME.proof.json]", required=False)
def command(text: str, proof: str | None) -> None:
    """Check a controller text by the proof that `yarcc --proof` has written beside it, with a small separate
    checker: standard library, integers and fractions.

    It prints the robot and the program of the proof, and the properties that were checked, that the program
    exempts from its limits, and that were not checked. The exit status is 0 if all was checked, 1 if the text
    or its proof was refused, 3 if no fault was found but a part wasn't checked.
    """
    from yarclang.verify.__main__ import main

    raise SystemExit(main([text, proof or str(Path(text).with_suffix(".proof.json"))]))
