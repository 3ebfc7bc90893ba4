"""Random programs for robots, and an independent check of the controller texts to which they compile.

`drawing.py`, `chains.py`, `rules.py` and `timetables.py` draw the programs, `judging.py` checks their texts,
`state.py` stores the progress, and `report.py` reports the results.
"""
