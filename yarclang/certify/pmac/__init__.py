"""The judge's own reader of a text for a Turbo PMAC, and what only such a text must fulfil.

`reader.py` is the door: `read.py` reads the text, with `cursor.py` line by line, `course.py` what stands
between start and CLOSE, `moves.py` lines of live motions; `own.py` is what only this kind says. `guard.py`
proves the guard of the buffer, `assignments.py` what is assigned. `settings/` judges the settings of the
controller.
"""
