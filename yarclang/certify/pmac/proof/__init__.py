"""Writer of proofs that `yarclang.verify`, a small checker, can check without any search.

`document.py` writes the whole proof, `shares.py` the path parameter s(t) of each motion.
"""
