"""Syntax tree to checked program: names, frames, units, values, flow.

`check.py` is the door, `context.py` what all of its parts share. `names/` knows what names mean, `values/`
what expressions and numbers are worth, `declared/` carries declarations out, `control/` loops and calls,
`motions/` reads motion commands and `actions.py` all others. `files.py` has the program and its modules,
`indices.py` checks indices, `parts.py` the parts that a statement doesn't take; `recalling.py` keeps what was
read before.
"""
