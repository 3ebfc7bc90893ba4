"""`python -m yarclang.verify NAME.pmc NAME.proof.json`."""

import sys
from pathlib import Path

from yarclang.verify.verdict import Verdict, verify

ACCEPTED, REFUSED, USAGE, UNCHECKED = 0, 1, 2, 3
"""The exit status: all was checked; refused; wrong usage; nothing is wrong, and something wasn't checked."""


def status_of(verdict: Verdict) -> int:
    """Return the exit status of a verdict."""
    return REFUSED if verdict.refused else UNCHECKED if verdict.unchecked else ACCEPTED


def report(name: str, verdict: Verdict) -> str:
    """Return a verdict in words."""
    if verdict.refused:
        return f"{name}: refused: {verdict.refused}"
    lines = [f"{name}: nothing wrong in what was checked"]
    for title in ("told", "checked", "unchecked"):
        lines += [f"{title}:", *(f"  {one}" for one in getattr(verdict, title))]
    return "\n".join(lines)


def main(arguments: list[str]) -> int:
    """Verify a text by its proof; return the exit status."""
    if len(arguments) != 2:
        sys.stderr.write("usage: python -m yarclang.verify NAME.pmc NAME.proof.json\n")
        return USAGE
    try:
        text, proof = (Path(one).read_bytes() for one in arguments)
    except OSError as error:
        sys.stderr.write(f"{error.filename}: {error.strerror}\n")
        return USAGE
    verdict = verify(text, proof)
    (sys.stderr if verdict.refused else sys.stdout).write(f"{report(arguments[0], verdict)}\n")
    return status_of(verdict)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
