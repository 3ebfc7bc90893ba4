"""Motion programs, rotaries and PLCs: their storage, linking and execution.

`buffers.py` stores the lines that ports send, and `program.py` links them. `calculation.py` turns a motion
program into steps, with its modal state (`moves.py`); `ahead.py` calculates some steps before the motion
needs them. `plc.py` is one PLC, and `plcs.py` schedules the scans. `surroundings.py` is the controller as
programs see it.
"""
