"""Syntax tree to checked program: names, frames, units, values, flow.

`check.py` is the entry, `context.py` has the inputs that all parts share. `names/` resolves names, `values/`
evaluates expressions and numbers, `declared/` carries out declarations, `control/` carries out loops and
calls, `motions/` reads motion commands and `actions.py` all other commands. `files.py` holds the program and
its modules, `indices.py` checks indices, `parts.py` refuses parts that a statement doesn't take, and
`recalling.py` caches the steps of commands.
"""
