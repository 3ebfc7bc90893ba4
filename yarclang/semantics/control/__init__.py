"""Carry out a program's loops, conditions and calls at compile time, which gives a flat list of steps.

`unroll.py` carries out a program. `repeats.py` reads REPEAT, `calling.py` CALL and `parameters.py` the
parameters of a SUB; `arguments.py` names the arguments of calls in findings. `counting.py` counts the
commands of loops and calls in advance, `extent.py` limits how many of them are carried out, and `places.py`
builds the places of steps.
"""
