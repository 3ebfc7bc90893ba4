"""Check the zones of a cell: the bodies and points that they watch, the distances of these from the zones'
borders, and the proof that the zones are respected along a motion.
"""
