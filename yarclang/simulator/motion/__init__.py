"""How motors move: cubics in time, blended moves, jogs, the time base, limits.

`pieces.py` has motions as cubics. `motors.py` is a motor and its own motions; `system.py` is a coordinate
system, which takes the steps of a program (`steps.py`), makes pieces of them (`sequences.py`) for its axes
(`axes.py`), and has a drive (`drive.py`) that executes them at the pace of its time base (`timebase.py`).
`trips.py` stops motors at limits and faults, `recorder.py` keeps what they did.
"""
