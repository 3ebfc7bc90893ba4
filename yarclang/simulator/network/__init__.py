"""The simulator on a network, or within the process that uses it.

`ports.py` defines the ports that send lines, and `reply.py` the answers. `ethernet.py` is the protocol
without a socket, `server.py` its socket and clock. `embedded.py` is a server within the client's process;
`leash.py` synchronizes its time with the client's.
"""
