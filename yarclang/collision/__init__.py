"""Measure distances between the bodies of a robot and its cell, and prove that they stay apart along a
motion.
"""
