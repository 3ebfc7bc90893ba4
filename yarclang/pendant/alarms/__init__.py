"""Alarms: each records a fault, the state of the robot at that time, and the user who acknowledged the
alarm.
"""
