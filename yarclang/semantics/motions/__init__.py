"""Read motion commands, and build from them the motion primitives that the planner knows.

`line.py` holds a command that is being read. `moved.py` reads its frames, `goals.py` its goals, `times.py`
its motion time, `options.py` its options, `searching.py` its UNTIL and `allowing.py` its ALLOW. `timed.py`
reads timetables, and `trajectory_file.py` their files. `to_hir.py` builds the primitive.
"""
