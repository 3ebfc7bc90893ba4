"""Proofs about the bodies of robot, load and cell: clearances, zones, torques, carried parts.

`sweep.py` prepares the motions for these proofs. `clearance.py` proves distances, `zones.py` zones;
`handled.py` follows the parts that grippers move, and checks grippers. `torque.py` proves torques, with the
bounds in `torque_bounds.py`. `remedy.py` proposes remedies in findings.
"""
