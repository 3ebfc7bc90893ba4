"""Proofs about bodies: clearances, zones, torques, parts that are carried."""
