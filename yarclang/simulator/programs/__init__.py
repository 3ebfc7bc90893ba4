"""Motion programs, rotaries and PLCs: how they are stored, linked, and executed.

`buffers.py` stores what ports send, `program.py` links it. `calculation.py` executes a motion program to
steps, with its modal state (`moves.py`), and `ahead.py` says how many of them ahead of the motion. `plc.py`
is one PLC, `plcs.py` when they are scanned. `surroundings.py` says what programs reach.
"""
