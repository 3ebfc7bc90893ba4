"""A checker of controller texts that can be read in an afternoon.

It decides by a proof that `yarcc --proof` has written (NAME.proof.json), with a reader of its own, in
integers and fractions, and imports nothing but the standard library. docs/certificate.md has the theorem.
`verdict.py` is the whole of it; `reader.py` reads the text, `course.py` judges what stands between motions,
`limits.py` joints and motors, `arm.py` says where the robot is, `paths.py` how far that is from the
programmed path, `chains.py` how motions flow into each other, `room.py` which bodies there are and what zones
watch, `apart.py` that bodies stay apart and zones are kept.
"""
