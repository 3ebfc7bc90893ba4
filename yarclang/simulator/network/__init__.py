"""The simulator on a network, or beside the code that uses it.

`ports.py` is who sends lines, `reply.py` what is answered. `ethernet.py` is the protocol without a socket,
`server.py` its socket and clock, `embedded.py` a server within the client's process, whose time `leash.py`
holds.
"""
