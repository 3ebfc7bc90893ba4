"""Random programs for robots, and an independent check of the texts to which they compile.

`drawing.py`, `chains.py` and `timetables.py` draw the programs, `judging.py` checks them, `state.py` stores
the progress, and `report.py` reports the results.
"""
