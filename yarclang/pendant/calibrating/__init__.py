"""Calibration at the pendant: the robot's positions that a user records at touched points or at joint
marks, the result that follows from them, and writing the result to a file.
"""
