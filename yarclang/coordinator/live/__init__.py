"""Motions that nobody knows to their end: jogs, velocities, a master that is followed. All of it is pure: time is an argument.

`grid.py` makes control points of wanted joint velocities within the limits, `steering.py` joint velocities of what people want,
`proof.py` judges the text that is made of them by the certificate's arithmetic, and `generator.py` puts them together: nothing
is streamed before it is proved, with a way to rest behind it.
"""
