"""Garbage collection is rare during long programs, and left out at the end of the process."""

import subprocess
import sys

PROGRAM = """
import atexit, gc
atexit.register(lambda: print(gc.get_freeze_count() > 1000))  # the last one, for it came first
from yarclang.cli.garbage import seldom_look_for_garbage
before = gc.get_threshold()[0]
seldom_look_for_garbage()
seldom_look_for_garbage()
print(gc.isenabled() and gc.get_threshold()[0] > 10 * before, gc.get_freeze_count())
"""


def test_garbage_is_looked_for_seldom_and_not_at_the_end():
    ended = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
    assert ended.stdout.split() == ["True", "0", "True"]
