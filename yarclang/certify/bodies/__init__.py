"""Proofs about bodies: clearances, zones, torques, parts that are carried.

`sweep.py` has the motions as bodies need them: `clearance.py` proves distances, `zones.py` zones,
`handled.py` where parts are and how they are taken. `torque.py` proves torques, with the bounds of
`torque_bounds.py`. `remedy.py` is what findings propose.
"""
