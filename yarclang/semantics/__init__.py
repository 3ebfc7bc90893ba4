"""Convert a syntax tree to a checked program: names, frames, units, values and the order of execution.

`check.py` is the entry, and `context.py` has the inputs that all these modules share. `names/` resolves
names, `values/` evaluates expressions and numbers, `declared/` carries out declarations, `control/` carries
out loops and calls, `motions/` reads motion commands, and `actions.py` reads all other commands. `files.py`
holds the program and its modules, `indices.py` checks indices, `parts.py` refuses syntax that a statement
doesn't accept (such as a frame or a motion time), and `recalling.py` caches the steps of commands.
"""
