"""Check zones of a cell: the items that they watch, the distances of these items from the zones' borders, and
the proof that the zones are respected along a motion.
"""
