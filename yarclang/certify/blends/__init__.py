"""Proofs of places where one motion flows into the next.

`flows.py` finds these places, `corner.py` where the programmed paths meet, `tangent.py` when corners are
passed that may not be left. `ball.py` proves that the frame stays in the ball of a blend, and `blend.py`
judges each place by it.
"""
