"""The simulator on a network, or within the process that uses it.

`ports.py` defines the controller's ports, to which clients send lines, and `reply.py` the replies to lines.
`ethernet.py` is the protocol without a socket, `server.py` its socket and clock. `embedded.py` is a server
within the client's process; `leash.py` synchronizes the simulator's time with that of its client.
"""
