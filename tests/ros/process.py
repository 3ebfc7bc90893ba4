"""`yarc ros` and `yarc serve` in processes of their own."""

import os
import re
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager

SCRIPT = "from yarclang.cli.yarc import main; main()"


class Told:
    """The output of a process, read continuously, so that the process never waits to print."""

    def __init__(self, process):
        self.process, self.lines = process, []
        self._arrived = threading.Condition()
        self._reading = threading.Thread(target=self._read, daemon=True)
        self._reading.start()

    def _read(self):
        for line in self.process.stdout:
            with self._arrived:
                self.lines.append(line)
                self._arrived.notify_all()
        with self._arrived:
            self.lines.append("")
            self._arrived.notify_all()

    def until(self, pattern, within=60.0):
        """Return the match of the first line that matches a pattern."""

        def found():
            matches = (re.search(pattern, line) for line in self.lines)
            return next((one for one in matches if one), None) or (self.lines and self.lines[-1] == "")

        with self._arrived:
            match = self._arrived.wait_for(found, within)
        assert isinstance(match, re.Match), "".join(self.lines)
        return match

    def end(self):
        """End the process by SIGTERM, and return its exit status."""
        self.process.send_signal(signal.SIGTERM)
        try:
            return self.process.wait(60)
        finally:
            self.process.kill()
            self.process.wait()
            self._reading.join(10.0)
            self.process.stdout.close()


@contextmanager
def yarc(*arguments, folder):
    """Run a command of yarc as long as the context lasts.

    Only commands in the same folder find its robot.
    """
    process = subprocess.Popen(
        [sys.executable, "-u", "-c", SCRIPT, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        cwd=folder,
        env={**os.environ, "XDG_RUNTIME_DIR": str(folder)},
    )
    told = Told(process)
    try:
        yield told
    finally:
        if process.poll() is None:
            told.end()


def ports_of(told):
    """Return the ports of a listening `yarc ros`."""
    found = told.until(r"motion link on port (\d+), state link on port (\d+)")
    return int(found[1]), int(found[2])
