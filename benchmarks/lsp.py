"""Measure the language server for RESULTS.md: `python benchmarks/lsp.py`, in an environment with
yarclang[dev].

A small client talks to `yarc lsp` over standard input and output, like an editor to which the server sends
findings without being asked. It measures the time from the start of the process, or from an edit, to the
findings.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from lint import long_program

YARC = (sys.executable, "-c", "from yarclang.cli.yarc import main; main()", "lsp")
EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "07_inspection_tour.yarc"
COMMANDS = 1_000
LINES = 10_000
EDITS = 1_000
KEYSTROKE = 0.2
"""Time between the keystrokes of a fast typist [s]."""


class Client:
    """A server and the messages to it. `seconds` count from its start."""

    def __init__(self) -> None:
        self.begun = time.perf_counter()
        self._process = subprocess.Popen(
            YARC, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        )
        self._number = 0
        capabilities = {"textDocument": {"publishDiagnostics": {}}}
        self.ask("initialize", {"processId": None, "rootUri": None, "capabilities": capabilities})
        self.tell("initialized", {})

    @property
    def pid(self) -> int:
        return self._process.pid

    def tell(self, method: str, params: Any, number: int | None = None) -> None:
        message = {"jsonrpc": "2.0", "method": method, "params": params}
        if number is not None:
            message["id"] = number
        body = json.dumps(message).encode()
        assert self._process.stdin is not None
        self._process.stdin.write(f"Content-Length: {len(body)}\r\n\r\n".encode() + body)
        self._process.stdin.flush()

    def ask(self, method: str, params: Any) -> Any:
        """Send a request and return its answer."""
        self._number += 1
        self.tell(method, params, self._number)
        return next(one for one in self.messages() if one.get("id") == self._number).get("result")

    def messages(self) -> Iterator[dict[str, Any]]:
        """Yield the server's messages."""
        assert self._process.stdout is not None
        while True:
            size = 0
            while line := self._process.stdout.readline().strip():
                if line.lower().startswith(b"content-length:"):
                    size = int(line.split(b":")[1])
            yield json.loads(self._process.stdout.read(size))

    def findings(self, version: int) -> list[dict[str, Any]]:
        """Return the next findings for a version of a text."""
        for one in self.messages():
            if one.get("method") == "textDocument/publishDiagnostics" and one["params"]["version"] == version:
                return list(one["params"]["diagnostics"])
        raise AssertionError

    def open(self, path: Path, text: str) -> str:
        uri = path.as_uri()
        item = {"uri": uri, "languageId": "yarc", "version": 1, "text": text}
        self.tell("textDocument/didOpen", {"textDocument": item})
        return uri

    def write(self, uri: str, version: int, line: int, column: int, end: int, text: str) -> None:
        """Replace some columns of a line (all from 0)."""
        place = {"start": {"line": line, "character": column}, "end": {"line": line, "character": end}}
        document = {"uri": uri, "version": version}
        changes = [{"range": place, "text": text}]
        self.tell("textDocument/didChange", {"textDocument": document, "contentChanges": changes})

    def close(self) -> None:
        self.ask("shutdown", None)
        self.tell("exit", None)
        self._process.wait(30)


def started(rounds: int) -> list[float]:
    """Return the seconds from the start of a process to its first findings."""
    found = []
    for _ in range(rounds):
        client = Client()
        client.open(EXAMPLE, EXAMPLE.read_text())
        client.findings(1)
        found.append(time.perf_counter() - client.begun)
        client.close()
    return found


def planned_program(count: int) -> str:
    """Return a program of motions that can all be planned: lines between ten poses."""
    rows = ["ROBOT INDUSTRIAL6", "DEFAULT {TCP} [50%] (mm,deg,s) {B}", "P00001 MOVEJ 0 -10 -20 0 -60 0"]
    rows += [
        f"P{n + 2:05} MOVEL {n % 10 * 20} 1000 {1050 + n % 7 * 10} -90 0 {n % 3}" for n in range(count - 1)
    ]
    return "\n".join([*rows, ""])


def edited(
    client: Client, uri: str, text: str, line: int, rounds: int, first: int
) -> tuple[list[float], list[float]]:
    """Return the seconds from an edit of a line's last digit to the first findings, and to those with
    planning, which come before the proof.
    """
    quick, whole = [], []
    end = len(text.split("\n")[line])
    for number in range(rounds):
        version = first + number
        begun = time.perf_counter()
        client.write(uri, version, line, end - 1, end, str(number % 3))
        client.findings(version)
        quick.append(time.perf_counter() - begun)
        client.findings(version)
        whole.append(time.perf_counter() - begun)
        time.sleep(KEYSTROKE)
    return quick, whole


def memory(pid: int) -> float:
    """Return the memory of a process [MB]."""
    status = Path(f"/proc/{pid}/status").read_text()
    return int(next(line for line in status.splitlines() if line.startswith("VmRSS")).split()[1]) / 1024.0


def row(what: str, seconds: list[float], goal: str) -> None:
    ordered = sorted(seconds)
    print(
        f"| {what} | {statistics.median(seconds) * 1e3:.0f} ms | "
        f"{ordered[int(0.9 * (len(ordered) - 1))] * 1e3:.0f} ms | {goal} |",
        flush=True,
    )


def main() -> None:
    """Measure everything, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--edits", type=int, default=EDITS)
    options = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="yarclang-lsp-"))
    print("| what | median | one in ten takes more than | goal |\n|---|---|---|---|")
    row(
        "start of the process to the first findings of 07_inspection_tour.yarc",
        started(options.rounds),
        "1.5 s",
    )
    client = Client()
    text = planned_program(COMMANDS)
    uri = client.open(folder / "planned.yarc", text)
    client.findings(1)
    client.findings(1)
    rounds = 4 * options.rounds
    for name, line in (("the last tenth", COMMANDS - 40), ("the first tenth", 40)):
        edited(client, uri, text, line, 2, 1_000 + line)
        quick, whole = edited(client, uri, text, line, rounds, 10_000 + line)
        row(f"an edit in {name} of {COMMANDS:,} commands to findings of syntax and names", quick, "20 ms")
        row("the same to findings with planning", whole, "50 ms" if "last" in name else "")
    long = long_program(LINES)
    other = client.open(folder / "long.yarc", long)
    client.findings(1)
    quick = []
    for number in range(rounds):
        begun = time.perf_counter()
        client.write(other, 2 + number, LINES // 2, 7, 8, "[" if number % 2 == 0 else "M")
        client.findings(2 + number)
        quick.append(time.perf_counter() - begun)
        time.sleep(KEYSTROKE)
    row(f"an edit in {LINES:,} lines to findings of syntax", quick, "50 ms")
    client.tell("textDocument/didClose", {"textDocument": {"uri": other}})
    held = []
    for number in range(options.edits):
        version = 100_000 + number
        client.write(uri, version, COMMANDS - 30, 7, 7, " ")
        client.findings(version)
        if number == options.edits // 10:
            held.append(memory(client.pid))
    held.append(memory(client.pid))
    client.close()
    print(
        f"\nmemory after {options.edits // 10:,} edits {held[0]:.0f} MB, after {options.edits:,} edits "
        f"{held[1]:.0f} MB"
    )


if __name__ == "__main__":
    main()
