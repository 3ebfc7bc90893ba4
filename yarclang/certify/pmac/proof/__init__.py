"""Writes a proof that `yarclang.verify` can follow without search: `document.py` the whole of it, `shares.py` s(t) of each motion."""
