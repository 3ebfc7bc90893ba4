"""Calibration at the pendant: touches of a session, what they say, where the result is written."""
