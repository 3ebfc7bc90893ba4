"""TCPad, the pendant: pages in a browser, and the documented API that they use, for the people at one robot.

A door on the coordinator: nothing is planned, proved or run here. `accounts/` knows who may do what, `web/` serves the API, `watched.py` and `seats.py` are the
way to the robot, `pages/` is what browsers are given.
"""
