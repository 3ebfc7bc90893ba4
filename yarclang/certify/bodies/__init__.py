"""Proofs about bodies: clearances, zones, torques, carried parts.

`sweep.py` prepares the motions for these proofs. `clearance.py` proves distances, `zones.py` zones;
`handled.py` follows parts and checks grippers. `torque.py` proves torques, with the bounds in
`torque_bounds.py`. `remedy.py` proposes remedies in findings.
"""
