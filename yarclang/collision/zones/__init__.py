"""Check the zones of a cell: which bodies and points they watch, how far these are from the zones' borders,
and the proof that the zones are respected along a motion.
"""
