"""Loops, conditions and calls, carried out to a flat list of steps.

`unroll.py` carries them out. `repeats.py` is REPEAT, `calling.py` CALL, `parameters.py` what a SUB takes,
`arguments.py` what a call has given. `counting.py` counts what a loop comes to before it is carried out,
`extent.py` says how much of it is, and `places.py` where a step comes from.
"""
