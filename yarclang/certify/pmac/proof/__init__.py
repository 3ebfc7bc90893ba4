"""Writer of proofs that `yarclang.verify` checks without search: `document.py` the whole proof, `shares.py`
s(t) of each motion.
"""
