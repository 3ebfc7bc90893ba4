"""Proofs about the bodies of robot, load and cell: clearances, zones, torques, carried parts.

`sweep.py` prepares the motions for these proofs. `clearance.py` proves distances between bodies, and
`zones.py` proves that zones are respected. `handled.py` traces the parts that grippers move, and checks the
use of grippers. `torque.py` proves torques, with the bounds in `torque_bounds.py`. `remedy.py` proposes
remedies in findings.
"""
