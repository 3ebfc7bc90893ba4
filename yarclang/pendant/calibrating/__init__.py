"""Calibration at the pendant: the touches of a session, their results, and writing results to files."""
