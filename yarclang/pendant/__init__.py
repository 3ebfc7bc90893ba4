"""TCPad, the pendant: pages in a browser for the people at one robot, and the documented API that the pages
use.

The pendant is a client of the coordinator: it plans, proves and runs nothing itself. `accounts/` decides who
may do what, `web/` serves the API, `watched.py` and `seats.py` connect to the robot, and `pages/` holds the
pages that browsers load.
"""
