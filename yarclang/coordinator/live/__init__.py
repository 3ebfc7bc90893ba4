"""Motions whose end is not known in advance: jogs, velocities, a master that is followed. All functions are
pure: time is an argument.

`steering.py` computes joint velocities from targets, `grid.py` computes control points from joint velocities
within the limits, and `proof.py` verifies the text of these points with the certificate's arithmetic.
`generator.py` combines them: nothing is streamed before it is proved, together with a way to rest after it.
"""
