"""Alarms: what went wrong, where the robot stood, and who has acknowledged it."""
