"""The judge's own reader of texts for a Turbo PMAC, and the checks that only such texts need.

`reader.py` is the entry point. `read.py` reads the text: `cursor.py` line by line, `course.py` from the start
to CLOSE, `moves.py` the lines of live motions. `own.py` defines the content that only texts of this kind
have. `guard.py` proves the guard of the buffer, `assignments.py` checks all assignments. `settings/` judges
the settings of the controller.
"""
