"""Conversion of other files to YARC programs: tables, ROS trajectories, named states of an SRDF."""
