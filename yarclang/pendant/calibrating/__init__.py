"""Calibration at the pendant. The user moves the robot to touched points or to marks on the joints and
records its positions. The result is computed from them and written to a file.
"""
