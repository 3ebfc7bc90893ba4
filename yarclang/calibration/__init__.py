"""Calibrations that use the arm itself as the measuring device: the tip of a tool, a frame, the zeros of the
joints.

This package only computes; it moves nothing.
"""
