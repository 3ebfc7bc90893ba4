"""Proofs of blends, in which one motion flows into the next.

`starts.py` finds the points at which the programmed paths begin, `flows.py` the blends, `tangent.py` the
times at which the robot passes corners without a blend radius. `ball.py` bounds how far the moving frame gets
from the corner in a blend, and `blend.py` judges each blend by these bounds.
"""
