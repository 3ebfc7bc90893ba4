"""One process that owns a robot: what it is told, how that is planned, certified and moved, and what those who watch hear of it.

`Coordinator` (`coordinator.py`) is the door for interpreters, pendants and bridges; docs/coordinator.md
describes it. Its clients (`client/`) share one robot (`shared.py`), and one task talks to the controller
(`engine.py`). `messages/` is all that is said; `desk.py` carries messages out, `serving.py` takes them from a
socket, `attached.py` is a door's side. `live/` is motions that nobody knows to their end.
"""
