"""Proofs of blends, in which one motion flows into the next.

`flows.py` finds the blends, `corner.py` the points where the programmed paths meet, `tangent.py` the times at
which the robot passes corners without a blend radius. `ball.py` bounds how far the moving frame gets from
the corner in a blend, and `blend.py` judges each blend by these bounds.
"""
