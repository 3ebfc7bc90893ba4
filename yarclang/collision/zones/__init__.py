"""Check zones of a cell: what they watch, its distance from their borders, and the proof that it stays so
along a motion.
"""
