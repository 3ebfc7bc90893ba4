"""Conversion of other files to YARC programs: tables of targets, ROS trajectories, named states of an
SRDF.
"""
