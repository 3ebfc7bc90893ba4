"""The judge's own reader of texts for a Turbo PMAC, and the checks for such texts only.

`reader.py` is the entry point. `read.py` reads the text: `cursor.py` line by line, `course.py` from the start
to CLOSE, `moves.py` the lines of live motions. `own.py` defines the content that only this kind has.
`guard.py` proves the guard of the buffer, `assignments.py` checks all assignments. `settings/` judges the
settings of the controller.
"""
