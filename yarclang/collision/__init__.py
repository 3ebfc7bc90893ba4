"""Measure distances between the bodies of a robot and of its cell, and prove that these bodies stay apart
along a motion.
"""
