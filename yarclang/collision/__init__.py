"""Measure distances between the bodies of a robot and its cell, and prove that these bodies stay apart
along a motion.
"""
