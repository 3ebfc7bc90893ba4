"""Calibrations that use the arm itself as the measuring device: of the tip of a tool, of a frame, and of the
zero positions of the joints.

This package only computes; it moves nothing.
"""
