"""A simulated controller that executes a table of knots in its own thread. It answers each line."""

from __future__ import annotations

import socketserver
import threading
import time

import numpy as np


class Simulated:
    """A simulator that listens on `port`; `fail()` causes a fault."""

    def __init__(self, stands, rate):
        self.rows, self.segment, self.place = [], 1.0, np.array(stands)
        self.state, self.rate, self.done, self.since = "idle", rate, 0.0, 0.0
        self.lock = threading.Lock()
        outer = self

        class Handler(socketserver.StreamRequestHandler):
            def handle(self):
                for line in self.rfile:
                    self.wfile.write((outer.answer(line.decode().strip()) + "\n").encode())

        socketserver.ThreadingTCPServer.daemon_threads = True
        self.server = socketserver.ThreadingTCPServer(("127.0.0.1", 0), Handler)
        self.port = self.server.server_address[1]

    def __enter__(self):
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        return self

    def __exit__(self, *_):
        self.server.shutdown()
        self.server.server_close()

    def fail(self):
        """Put the drives into a fault."""
        with self.lock:
            self.advance()
            self.state = "fault"

    def advance(self):
        """Execute all rows whose time has passed."""
        now = time.monotonic()
        if self.state == "run":
            self.done += (now - self.since) * self.rate
            while self.rows and self.done >= self.rows[0][0]:
                took, point = self.rows.pop(0)
                self.done -= took
                self.place = self.place if point is None else point
            self.state = self.state if self.rows else "idle"
        self.since = now

    def answer(self, line):
        with self.lock:
            self.advance()
            word, _, rest = line.partition(" ")
            if word == "push" and rest.startswith("T,"):
                self.segment = float(rest[2:]) / 1e3
            elif word == "push" and rest.startswith("D,"):
                self.rows.append((float(rest[2:]) / 1e3, None))
            elif word == "push":
                self.rows.append((self.segment, np.array([float(one) for one in rest.split(",")])))
            elif word in ("run", "hold") and self.state != "fault":
                self.state, self.done = word, self.done if self.state == "hold" else 0.0
            elif word in ("stop", "clear"):
                self.rows, self.state = [], "idle"
            return f"{self.state} {len(self.rows)} {','.join(f'{one:.6f}' for one in self.place)}"
