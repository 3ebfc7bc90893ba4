"""Motion programs, rotaries and PLCs: their storage, linking and execution.

`buffers.py` stores the lines that ports send, and `program.py` links them. `calculation.py` turns a motion
program into steps, with its modal state (`moves.py`); `ahead.py` keeps some of them calculated ahead of the
motion. `plc.py` is one PLC, and `plcs.py` schedules the scans. `surroundings.py` is the machine as programs
see it.
"""
