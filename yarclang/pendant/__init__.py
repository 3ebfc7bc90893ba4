"""TCPad, the pendant: pages in a browser for the people at one robot, and the documented API that the pages
use.

The pendant is a client of the coordinator, which plans, proves and runs everything. `accounts/` decides who
may do what, and `web/` serves the API. `watched.py` and `seats.py` connect to the coordinator. `pages/` holds
the pages that browsers load.
"""
