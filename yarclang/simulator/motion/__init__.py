"""The motion of motors: cubics in time, blended moves, jogs, the time base, limits.

`pieces.py` has motions as pieces, which are cubics in time. `motors.py` is a motor with its jogs, home
searches and aborts. `system.py` is a coordinate system: it takes the steps of a program (`steps.py`), turns
them into pieces (`sequences.py`) for its axes (`axes.py`), and has a drive (`drive.py`) that executes these
pieces at the rate of its time base (`timebase.py`). `trips.py` stops motors at limits and faults, and
`recorder.py` records their motions.
"""
