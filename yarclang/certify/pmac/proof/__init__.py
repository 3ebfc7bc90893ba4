"""Writer of proofs that `yarclang.verify` checks without search.

`document.py` writes the whole proof, `shares.py` s(t) of each motion.
"""
