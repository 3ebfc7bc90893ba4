"""Calibration at the pendant: the touches of a session, their results, and the files that get the results."""
