"""Run yarc or yarcc, or import modules, as on a system without what only Unix has.

    python without_unix.py yarc check first.yarc
    python without_unix.py imports yarclang.lsp.server

Unix modules can't be imported, and Unix names are removed. Paths, processes and files still work as on Linux.
"""

import importlib
import importlib.abc
import os
import signal
import socket
import sys

MODULES = {"curses", "fcntl", "grp", "pty", "pwd", "readline", "resource", "syslog", "termios", "tty"}
NAMES = {
    os: "fork forkpty getuid geteuid getgid getegid getpgid getpgrp killpg setsid fchmod fchown mkfifo "
    "sched_getaffinity register_at_fork O_NOFOLLOW O_DIRECTORY O_NONBLOCK O_CLOEXEC O_NOCTTY",
    signal: "SIGALRM SIGHUP SIGUSR1 SIGUSR2 SIGKILL SIGQUIT SIGPIPE SIGWINCH SIGTSTP SIGCONT pthread_sigmask",
    socket: "AF_UNIX socketpair",
}


class Hidden(importlib.abc.MetaPathFinder):
    """A finder that finds no Unix module."""

    def find_spec(self, name, path=None, target=None):
        if name in MODULES:
            raise ModuleNotFoundError(f"No module named {name!r}: it is hidden", name=name)


def hide():
    for name in MODULES:
        sys.modules.pop(name, None)
    sys.meta_path.insert(0, Hidden())
    for module, names in NAMES.items():
        for name in names.split():
            if hasattr(module, name):
                delattr(module, name)


if __name__ == "__main__":
    hide()
    sys.argv = sys.argv[1:]
    if sys.argv[0] == "imports":
        for each in sys.argv[1:]:
            importlib.import_module(each)
            print(each)
    else:
        importlib.import_module(f"yarclang.cli.{sys.argv[0]}").main()
