"""An independent checker of controller texts (the compiler's output) that is small enough to be read in an
afternoon.

It checks a controller text by its proof, which `yarcc --proof` writes (NAME.proof.json). It has a reader of
its own, computes with integers and fractions, and imports nothing but the standard library.
docs/certificate.md has the theorem. `verdict.py` combines all checks. `reader.py` reads the controller text,
`course.py` checks the actions between motions, and `limits.py` the limits of joints and motors. `arm.py` has
the arm's kinematics. `paths.py`, `joints.py` and `poses.py` have the kinds of paths, and a motion's distance
from them. `chains.py` checks each motion, and the blends between motions. `room.py` defines the bodies and
zones. `apart.py` checks that bodies stay apart, `conditions.py` path constraints and zones without planes,
and `parts.py` that workpieces stay in place when the arm takes or leaves them.
"""
