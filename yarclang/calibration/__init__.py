"""Calibrations with the arm itself: the tip of a tool, a frame, the zeros of the joints.

These are computations only; nothing here moves.
"""
