"""`python -m yarclang.verify NAME.pmc NAME.proof.json`."""

import sys
from pathlib import Path

from yarclang.verify.verdict import Verdict, verify

ACCEPTED, REFUSED, USAGE, UNCHECKED = 0, 1, 2, 3
"""Exit statuses: all checked and right; text refused; wrong usage; nothing wrong, but not all checked."""
LARGEST = 1 << 26
"""Largest size of a text or proof [bytes]. The numbers of a proof take up to 40 times its size in memory."""


def status_of(verdict: Verdict) -> int:
    """Return the exit status of a verdict."""
    return REFUSED if verdict.refused else UNCHECKED if verdict.unchecked else ACCEPTED


def printable(text: str) -> str:
    """Return a line in ASCII, with all other characters written as numbers, for output to a terminal.

    A terminal would interpret some of these characters, reverse the direction of writing, or lack them.
    Letters of other alphabets look like Latin ones.
    """
    return "".join(one if " " <= one <= "~" else f"\\u{ord(one):04x}" for one in text)


def report(name: str, verdict: Verdict) -> str:
    """Return the lines that report a verdict."""
    if verdict.refused:
        return f"{printable(name)}: refused: {printable(verdict.refused)}"
    lines = [f"{printable(name)}: nothing wrong in what was checked"]
    for title in ("told", "checked", "exempt", "unchecked"):
        lines += [f"{title}:", *(f"  {printable(one)}" for one in getattr(verdict, title))]
    return "\n".join(lines)


def main(arguments: list[str]) -> int:
    """Verify a controller text by its proof, report the verdict, and return the exit status."""
    if len(arguments) != 2:
        sys.stderr.write("usage: python -m yarclang.verify NAME.pmc NAME.proof.json\n")
        return USAGE
    read = []
    for name in arguments:
        try:
            with Path(name).open("rb") as file:
                read.append(file.read(LARGEST + 1))
        except (OSError, MemoryError) as error:
            sys.stderr.write(f"{printable(name)}: {getattr(error, 'strerror', None) or 'too large'}\n")
            return USAGE
        if len(read[-1]) > LARGEST:
            sys.stderr.write(f"{printable(name)}: larger than {LARGEST >> 20} MiB\n")
            return USAGE
    text, proof = read
    verdict = verify(text, proof)
    (sys.stderr if verdict.refused else sys.stdout).write(f"{report(arguments[0], verdict)}\n")
    return status_of(verdict)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
