"""Measure the small checker for RESULTS.md: `python benchmarks/verifying.py [--lines 1000]`, in an
environment with yarclang. Each text is compiled with its proof, then judged in a separate process.

Times are CPU times, the shortest of all rounds; the memory is the largest.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import programs
from measure import Process, process

ROOT = Path(__file__).resolve().parents[1]
LISTING4 = ROOT / "examples" / "01_listing4.yarc"
TM = "50"


def judged(folder: Path, name: str, text: str, rounds: int, *options: str) -> None:
    """Compile a program with its proof. Print the checker's time, and the sizes of text and proof.

    Args:
        folder: an empty folder for the files.
        name: the name of the row.
        text: the program.
        rounds: number of runs of the checker.
        options: options of yarcc.
    """
    (folder / "p.yarc").write_text(text, encoding="utf-8")
    yarcc = str(Path(sys.executable).with_name("yarcc"))
    words = (*options, "--robot", "INDUSTRIAL6", "--no-cache", "--proof", "-o", str(folder / "p.pmc"))
    made = process(yarcc, *words, str(folder / "p.yarc"))
    ended = [_verify(folder) for _ in range(rounds)]
    size, proof = (Path(folder, one).stat().st_size for one in ("p.pmc", "p.proof.json"))
    with (folder / "p.pmc").open() as lines:
        moves = sum(line.startswith("X") for line in lines)
    row = (
        f"{name} ({moves:,} moves)",
        f"{min(one.cpu for one in ended):.2f} s",
        f"{max(one.peak for one in ended):.0f} MB",
        f"{size / 1e6:.2f} MB",
        f"{proof / size:.2f} of it",
        f"{made.cpu:.1f} s",
    )
    print(f"| {' | '.join(row)} |", flush=True)


def _verify(folder: Path) -> Process:
    """Judge the text of a folder. The exit status must be that of a correct text."""
    code = (
        "import sys; from yarclang.verify.__main__ import main; "
        f"status = main({[str(folder / 'p.pmc'), str(folder / 'p.proof.json')]!r}); "
        "sys.exit(0 if status in (0, 3) else 1)"
    )
    return process(sys.executable, "-c", code)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lines", type=int, default=1000, help="number of MOVELs")
    parser.add_argument("--rounds", type=int, default=1, help="how often each text is judged")
    chosen = parser.parse_args()
    print(
        "| text | verdict, CPU | memory | text's size | proof | yarcc --proof, CPU |\n"
        "|---|---|---|---|---|---|"
    )
    many = programs.lines(chosen.lines)
    for name, text, options in (
        ("Listing 4", LISTING4.read_text(encoding="utf-8"), ()),
        (f"{chosen.lines:,} MOVELs of 1 s at TM {TM}", many, ("--tm", TM)),
    ):
        with tempfile.TemporaryDirectory() as folder:
            judged(Path(folder), name, text, chosen.rounds, *options)


if __name__ == "__main__":
    main()
