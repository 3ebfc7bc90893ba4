"""Declarations carried out.

`declaring.py` goes through those of a program and its modules. `meanings.py` gives names their meaning,
`cells.py` those of a cell.toml, `whole_file.py` is ROBOT, DEFAULT and START. `variables.py` holds that one
variable of the controller is one signal.
"""
