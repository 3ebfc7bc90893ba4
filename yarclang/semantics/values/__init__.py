"""Compute expressions, units and numbers. All mm and deg are converted to m and rad here.

`evaluate.py` computes the values of expressions, which are the amounts of `amounts.py`; `deciding.py` reads
expressions for run time, and `steps.py` converts analogue signals. `units.py` reads the units of a statement,
and `numbers.py` the values of a waypoint. `poses.py` checks limits and computes rotations.
"""
