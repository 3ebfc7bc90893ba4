"""The simulator on a network, or within the process that uses it.

`ports.py` has the senders of lines, and `reply.py` the answers. `ethernet.py` is the protocol without a
socket, `server.py` its socket and clock, and `embedded.py` a server within the client's process, whose time
`leash.py` keeps together with the client's.
"""
