"""Compare both checkers on the texts of changed compilers: `python benchmarks/verifying_mutants.py [--count
200]`.

Each mutant of `mutants.py` compiles the programs of `mutant_corpus.py`. A text that differs from the text of
the unchanged compiler is kept, even if the mutant's certificate refuses it. Then the unchanged judge and the
small checker read the kept text. The checker gets the proof of the unchanged compiler, with the hash of the
kept text.

If the judge refuses a text that the checker accepts, with nothing unchecked except torques, the text is
printed as `ACCEPTED`, and the exit status is 1. Results are kept line by line, so that a stopped run can be
continued.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

from mutant_corpus import cases, write  # after the threads are set: numpy comes with it
from mutants import LONGEST, Mutation, apart, chosen, place_of, with_change

WRITING = ("motion", "backend_pmac", "robot", "transforms.py")
"""Files whose code determines the written text. Changes elsewhere leave the text as it is."""


def written(folder: Path) -> dict[str, str]:
    """Return the first text that is written for each program, before any judgement."""
    import yarclang
    from yarclang.pipeline import stages

    texts: dict[str, str] = {}
    judging = stages.proved

    def kept(text: str, *given: Any, **options: Any) -> Any:
        texts.setdefault(name, text)
        return judging(text, *given, **options)

    stages.proved = kept
    for case in cases():
        name = case.name
        try:
            yarclang.compile(case.text, **place_of(case, folder))
        except Exception:
            continue
    return texts


def proofs(folder: Path) -> dict[str, dict[str, Any]]:
    """Return the proofs of all programs that the unchanged compiler accepts."""
    import yarclang
    from yarclang.pipeline.proofs import proof_of

    made = {}
    for case in cases():
        compiled = yarclang.compile(case.text, **place_of(case, folder)).value
        proof = None if compiled is None else proof_of(compiled).value
        if proof is not None:
            made[case.name] = json.loads(proof)
    return made


def verdicts(
    texts: dict[str, str], known: dict[str, dict[str, Any]], folder: Path
) -> list[tuple[str, str, str]]:
    """Return (program, the judge's reasons, the checker's verdict) of each text. There are no reasons if the
    judge accepts the text.
    """
    import yarclang
    from yarclang.verify.verdict import ALWAYS_UNCHECKED, verify

    rows = []
    for case in cases():
        if case.name not in texts or case.name not in known:
            continue
        text = texts[case.name]
        judged = yarclang.prove(text, case.text, **place_of(case, folder))
        codes = " ".join(sorted({each.code for each in judged.diagnostics if each.severity == "error"}))
        proof = known[case.name] | {"text": hashlib.sha256(text.encode()).hexdigest()}
        checked = verify(text.encode(), json.dumps(proof).encode())
        left = [each for each in checked.unchecked if each not in ALWAYS_UNCHECKED]
        seen = "refused" if checked.refused else "unchecked" if left else "accepted"
        rows.append((case.name, codes or ("" if judged.ok else "no verdict"), seen))
    return rows


def main() -> int:
    """Judge the texts of all mutants, and count the pairs of verdicts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--results", type=Path, default=Path("verifying_mutants.jsonl"))
    given = parser.parse_args()
    known: dict[str, Any] = {}
    if given.results.exists():
        known = {row["key"]: row for row in map(json.loads, given.results.read_text().splitlines())}
    drawn = [each for each in chosen(given.count, given.seed) if each.file.startswith(WRITING)]
    with tempfile.TemporaryDirectory(prefix="mutant-") as made, given.results.open("a") as out:
        folder = Path(made)
        write(folder)
        os.environ["YARCLANG_LOCKS"] = folder.name
        right, plain = proofs(folder), apart(lambda: written(folder), LONGEST)[1]
        for each in drawn:
            if each.key not in known:
                known[each.key] = {"key": each.key, "rows": _judged(each, plain, right, folder)}
                out.write(json.dumps(known[each.key]) + "\n")
                out.flush()
    counts: Counter[tuple[str, str]] = Counter()
    accepted = []
    for each in drawn:
        for name, codes, seen in known[each.key]["rows"]:
            counts[
                "refused by the judge" if codes else "accepted by the judge", f"{seen} by the checker"
            ] += 1
            if codes and seen == "accepted":
                accepted.append(f"ACCEPTED {each.key}: {name} ({codes})")
    changed = sum(bool(known[each.key]["rows"]) for each in drawn)
    print(f"{len(drawn)} mutants, {changed} of which write another text")
    for (judge, checker), count in sorted(counts.items()):
        print(f"{count:6} {judge}, {checker}")
    print("\n".join(accepted))
    return bool(accepted)


def _judged(
    mutation: Mutation, plain: dict[str, str], right: dict[str, dict[str, Any]], folder: Path
) -> list[tuple[str, str, str]]:
    def work() -> dict[str, str]:
        with_change(mutation)
        return written(folder)

    _, texts = apart(work, LONGEST)
    other = {name: text for name, text in (texts or {}).items() if text != plain.get(name)}
    _, rows = apart(lambda: verdicts(other, right, folder), 4 * LONGEST) if other else (True, [])
    return rows or []


if __name__ == "__main__":
    sys.exit(main())
