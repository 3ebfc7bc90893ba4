"""One process that owns a robot: what it is told, how that is planned, certified and moved, and what those who watch hear of it.

`Coordinator` (coordinator.py) is the door for interpreters, pendants and bridges; docs/coordinator.md describes it.
"""
