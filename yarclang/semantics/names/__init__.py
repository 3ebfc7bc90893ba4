"""Meanings of names: commands (`commands.py`), frames (`frames.py`), inputs and outputs (`signals.py`), and all of them in nested blocks (`scope.py`)."""
