"""Coordinator: the process that owns a robot. It accepts orders, plans and certifies motions, executes them,
and reports to all clients.

`Coordinator` (`coordinator.py`) is the entry point for interpreters, pendants and bridges;
docs/coordinator.md describes it. Its clients (`client/`) share one robot (`shared.py`), and one task talks to
the controller (`engine.py`). `messages/` contains all messages; `desk.py` carries out the orders among them,
`serving.py` receives them from a socket, and `attached.py` is the client's side. `live/` contains motions
whose end isn't known in advance.
"""
