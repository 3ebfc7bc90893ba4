"""Variables and memory (`registers.py`), and the registers that show the controller's state.

`wiring.py` connects registers to the motion, `status.py` has status words, and `saved.py` the copy for SAVE.
"""
