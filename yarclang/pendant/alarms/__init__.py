"""Alarms: what went wrong, where the robot stood, and which user has acknowledged it."""
