"""A checker of controller texts that is small enough to be read in an afternoon.

It checks a text by a proof that `yarcc --proof` has written (NAME.proof.json), with a reader of its own, in
integers and fractions, and imports nothing but the standard library. docs/certificate.md has the theorem.
`verdict.py` combines all checks; `reader.py` reads the text, `course.py` checks the actions between motions,
`limits.py` joints and motors, `arm.py` computes where the robot is, `paths.py` its distance from the
programmed path, which is one of `paths.py`, `joints.py` or `poses.py`. `chains.py` checks each motion, and
how motions flow into each other, `room.py` defines the bodies and zones, `apart.py` that bodies stay apart
and zones are respected, `parts.py` that parts stay where they are when the arm takes or leaves them.
"""
