"""Ctrl-C at a moment in which Python discards exceptions: it counts all the same."""

import subprocess
import sys

BEGIN = """
import asyncio, os, signal, time
from yarclang.cli.interrupts import repeat_lost_interrupts
repeat_lost_interrupts()

class Interrupted:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)
        for _ in range(1000):
            pass  # the signal's handler runs at one of these steps
"""
PLAIN = """
try:
    del made
    time.sleep(5)
    print("lost")
except KeyboardInterrupt:
    print("heard")
"""
IN_A_LOOP = """
async def work():
    asyncio.get_running_loop().call_soon(made.clear)
    await asyncio.sleep(5)
    print("lost")

made = [made]
try:
    asyncio.run(work())
except KeyboardInterrupt:
    print("heard")
"""
OF_THE_LOOP = """
async def work():
    heard = asyncio.Event()
    made.clear()
    asyncio.get_running_loop().add_signal_handler(signal.SIGINT, heard.set)
    await asyncio.wait_for(heard.wait(), 5)
    print("heard")

made = [made]
signal.signal(signal.SIGINT, signal.default_int_handler)
loop = asyncio.new_event_loop()
try:
    loop.run_until_complete(work())
except KeyboardInterrupt:
    print("heard")
"""
OTHERS = """
class Broken:
    def __del__(self):
        raise ValueError("as before")

del made.__class__.__del__
Broken()
print("heard")
"""


def printed(text):
    ended = subprocess.run(
        [sys.executable, "-c", BEGIN + "made = Interrupted()\n" + text],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    return ended.stdout, ended.stderr


def test_an_interrupt_in_a_destructor_is_repeated():
    assert printed(PLAIN) == ("heard\n", "")


def test_in_asyncio():
    assert printed(IN_A_LOOP) == ("heard\n", "")


def test_a_handler_of_the_loop_gets_the_repeated_one():
    assert printed(OF_THE_LOOP) == ("heard\n", "")


def test_other_discarded_exceptions_are_printed_as_before():
    out, err = printed(OTHERS)
    assert out == "heard\n"
    assert "ValueError: as before" in err


def test_every_command_repeats_them():
    program = """
import sys
from yarclang.cli.yarc import main
try:
    main(["explain", "Y0101"])
except SystemExit:
    print(sys.unraisablehook.__name__, file=sys.stderr)
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert ended.stderr == "_hook\n"
