"""Motion commands: goals, times, options, and the primitives that they become.

`line.py` is a command that is being read: its moving frame (`moved.py`), its goals (`goals.py`), its times
(`times.py`) and its options (`options.py`); `timed.py` reads timetables, and `trajectory_file.py` their
files. `to_hir.py` makes the primitive.
"""
