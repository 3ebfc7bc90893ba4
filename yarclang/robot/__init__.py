"""Robots: their description, kinematics and actuation, as plain data in SI."""
