"""The judge's own reader of controller texts for a Turbo PMAC, and the checks that only such texts need.

`reader.py` is the entry point. `read.py` reads the text: `cursor.py` line by line, `course.py` the part from
the start to CLOSE, `moves.py` the lines of live motions such as jogs. `own.py` defines the content that only
texts of this kind have. `guard.py` proves the guard of the rotary buffer, `assignments.py` checks all
assignments. `settings/` judges the settings of the controller.
"""
