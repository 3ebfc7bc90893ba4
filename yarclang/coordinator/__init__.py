"""A process that owns a robot: it takes orders, plans and certifies motions, executes them, and informs those
who watch.

`Coordinator` (`coordinator.py`) is the entry point for interpreters, pendants and bridges;
docs/coordinator.md describes it. Its clients (`client/`) share one robot (`shared.py`), and one task talks to
the controller (`engine.py`). `messages/` has all messages; `desk.py` carries them out, `serving.py` receives
them from a socket, and `attached.py` is the client's side. `live/` has motions whose end is not known in
advance.
"""
