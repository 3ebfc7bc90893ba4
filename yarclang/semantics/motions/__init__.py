"""Motion commands: their goals, times and options, and the primitives that are made of them.

`line.py` holds a command that is being read. `moved.py` reads its frames, `goals.py` its goals, `times.py`
its motion time, `options.py` its options and `searching.py` its UNTIL. `timed.py` reads timetables, and
`trajectory_file.py` their files. `to_hir.py` makes the primitive.
"""
