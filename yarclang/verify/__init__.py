"""An independent checker of controller texts (the compiler's output) that is small enough to be read in an
afternoon.

It checks a controller text by a proof that `yarcc --proof` has written (NAME.proof.json), with a reader of
its own, in integers and fractions, and imports nothing but the standard library. docs/certificate.md has the
theorem. `verdict.py` combines all checks; `reader.py` reads the controller text, `course.py` checks the
actions between motions, `limits.py` joints and motors, `arm.py` computes the arm's kinematics, `paths.py` its
distance from the programmed path. The kinds of paths are in `paths.py`, `joints.py` and `poses.py`.
`chains.py` checks each motion, and the blends between motions, `room.py` defines the bodies and zones,
`apart.py` checks that bodies stay apart and zones are respected, `parts.py` that workpieces stay where they
are when the arm takes or leaves them.
"""
