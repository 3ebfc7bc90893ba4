"""Carry out declarations.

`declaring.py` goes through the declarations of a program and its modules. `meanings.py` declares frames,
poses, joint positions and numbers, `cells.py` the names of a cell.toml; `whole_file.py` reads ROBOT, DEFAULT
and START. `variables.py` checks that each variable of the controller belongs to only one signal.
"""
