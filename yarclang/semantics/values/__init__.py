"""Expressions, units and numbers: mm and deg become m and rad here.

`evaluate.py` carries expressions out to `amounts.py`, numbers that may have a unit; `units.py` has the units
of a statement. `poses.py` makes joint positions and poses of numbers, `numbers.py` the values of a way-point.
"""
