"""Files of other kinds to YARC programs: tables, ROS trajectories, named states of an SRDF."""
