"""Proofs of blends, in which one motion flows into the next.

`flows.py` finds the blends, `corner.py` the points where the programmed paths meet, `tangent.py` the times at
which corners without a blend radius are passed. `ball.py` proves that the frame stays in the ball of a blend,
and `blend.py` judges each blend by it.
"""
