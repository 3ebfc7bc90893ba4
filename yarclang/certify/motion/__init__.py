"""Proofs of single motions: limits, paths, speeds.

`bounds.py` has the theorems, `pieces.py` the segments cut into pieces. `limits.py` proves joints and motors.
`deviations.py` asks each kind of motion for its proof: `joint.py` and `spline.py` in joint space, `timed.py`
for timetables, `frames.py` for paths of the moving frame, which `cartesian.py` compares with what is
programmed (`programmed.py`, `posespline.py`; `project.py` and `pose.py` serve them). `speed.py` proves
programmed speeds, `slowed.py` says where they aren't reached. `proved.py` is what all of them share.
"""
