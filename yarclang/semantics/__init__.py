"""Convert a syntax tree to a checked program: names, frames, units, values and the order of execution.

`check.py` is the entry, and `context.py` has the inputs that all parts share. `names/` resolves names,
`values/` evaluates expressions and numbers, `declared/` carries out declarations, `control/` carries out
loops and calls, `motions/` reads motion commands, and `actions.py` reads all other commands. `files.py` holds
the program and its modules, `indices.py` checks indices, `parts.py` refuses parts that a statement doesn't
accept, and `recalling.py` caches the steps of commands.
"""
