"""Random programs over robots, judged by an independent reading of what they compile to: `drawing.py`, `chains.py` and `timetables.py` draw,
`judging.py` judges, `state.py` keeps what is done, and `report.py` says what was found.
"""
