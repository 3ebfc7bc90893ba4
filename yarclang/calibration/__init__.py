"""Calibrate the tip of a tool, a frame, or the zero positions of the joints, with the arm itself as the
measuring device.

This package only computes; it moves nothing.
"""
