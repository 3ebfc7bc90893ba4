"""Proofs about single motions: limits, paths, speeds.

`bounds.py` contains the theorems, `pieces.py` cuts segments into pieces of time. `limits.py` proves the
limits of joints and motors. `deviations.py` chooses the proof of the path for each kind of motion: `joint.py`
and `spline.py` for joint space, `timed.py` for timetables, `frames.py` for paths of the moving frame, which
`cartesian.py` compares with the programmed paths (`programmed.py`, `posespline.py`, with `project.py` and
`pose.py` as helpers). `speed.py` proves programmed speeds, `slowed.py` reports where they are not reached.
`proved.py` contains the data that all proofs share.
"""
