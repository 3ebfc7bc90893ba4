"""Variables and memory (`registers.py`), and the state of the machine in them.

`wiring.py` connects registers to the motion, `status.py` has status words, and `saved.py` the copy for SAVE.
"""
