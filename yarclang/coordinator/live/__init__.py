"""Motions whose end isn't known in advance: jogs, motions at a given velocity, and motions that follow a
master. All functions are pure: time is an argument.

`steering.py` computes joint velocities from targets. `grid.py` turns joint velocities into control points
that keep the limits. `proof.py` verifies the text of these points with the certificate's arithmetic.
`generator.py` combines these steps: nothing is streamed before it is proved, together with a motion to rest
after it.
"""
