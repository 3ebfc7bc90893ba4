"""Coordinator: the process that owns a robot. It accepts orders, plans and certifies motions, executes them,
and reports to all clients.

`Coordinator` (`coordinator.py`) is the entry point for interpreters, pendants and bridges; it is described in
docs/coordinator.md. All clients (`client/`) share one robot (`shared.py`). Only one task communicates with
the controller (`engine.py`).

`messages/` contains all messages. `serving.py` receives orders from a socket, `desk.py` carries them out, and
`attached.py` is the client's side of the connection. `live/` contains motions whose end isn't known in
advance.
"""
