"""Resolve names.

`commands.py` resolves names of commands, `frames.py` frames, `signals.py` inputs and outputs; `scope.py`
holds all names that are declared in nested blocks. `foreign.py` knows words of other robot languages.
"""
