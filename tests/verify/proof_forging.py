"""Texts with their proofs, and forgeries of both.

A forger has the checker, so the hash of a forged text is put into its proof.
"""

import copy
import hashlib
import json
from functools import cache

from programs import compiled

from yarclang.pipeline.proofs import proof_of
from yarclang.verify.verdict import verify

MOTIONS = """DEFAULT {TCP} [MIN] (mm,deg,s) {B}
OUTPUT LAMP M20 OFF
INPUT DOOR M11
P0010 MOVEJ 10 -5 -40 5 30 0 [2]
P0020 MOVEL 150 1074.4 1250 10 -5 20 [4]
P0030 SET LAMP ON
P0040 MOVEC 50 1150 1200; -60 1174.4 1176 0 0 0 [4]
P0050 WAIT DOOR ON [5]
P0060 MOVEJ_SPLINE 20 0 -30 0 30 0; 0 -5 -20 10 40 5; -10 5 -20 0 30 0 [8]
P0070 DMOVE 0 0 -30 0 0 5 [2]
P0080 WAIT [0.5]
P0090 SET LAMP OFF
P0100 MOVEJ_RPY 0 1174.4 1176 0 0 0
P0110 STOP
"""
"""A program with all kinds of motions that are checked, outputs, a wait and a dwell."""

BLENDED = """DEFAULT {TCP} [3] (mm,deg,s) {B}
OUTPUT LAMP M20
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]
P0020 MOVEL 150 1174.4 1176 0 0 0 BLEND 20
P0030 SET LAMP ON
P0040 MOVEL 150 1074.4 1176 0 0 0
P0050 STOP
"""

WAYS = """DEFAULT (deg,s)
INPUT DOOR M11
P0010 MOVEJ 10 0 0 0 0 0 [2]
WHEN DOOR ON
  P0020 MOVEJ 20 0 0 0 0 0 [2]
ELSE
  P0030 MOVEJ 15 0 0 0 0 0 [2]
  P0040 MOVEJ 20 0 0 0 0 0 [2]
END
P0050 MOVEJ 0 0 0 0 0 0 [2]
P0060 STOP
"""


@cache
def made(program, robot="INDUSTRIAL6"):
    """Return the text and the proof of a program."""
    found, diagnostics = compiled(program, robot)
    assert found is not None, [one.message for one in diagnostics]
    proof = proof_of(found)
    assert proof.value is not None, proof.diagnostics
    return found.text, proof.value


def table(program, *, bodies=False):
    """Return the proof of a program as a dict that may be changed.

    It has no bodies by default, because they take most of the time and have tests of their own.
    """
    proof = json.loads(made(program)[1])
    if not bodies:
        proof |= {"cell": {"bodies": [], "exceptions": [], "zones": []}, "planes": []}
    return proof


def refused(text, proof):
    """Return why the checker refuses a text with a proof (a dict), or an empty text if it doesn't."""
    return verify(text.encode(), json.dumps(proof).encode()).refused


def refused_text(program, forged):
    """Return why the checker refuses a forged text, with a proof that has the forged text's hash."""
    proof = table(program)
    proof["text"] = hashlib.sha256(forged.encode()).hexdigest()
    return refused(forged, proof)


def numbers(value, path=()):
    """Yield the paths of all numbers in a proof."""
    if isinstance(value, dict):
        for name, one in value.items():
            yield from numbers(one, (*path, name))
    elif isinstance(value, list):
        for place, one in enumerate(value):
            yield from numbers(one, (*path, place))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path


def changed(proof, path, change):
    """Return a copy of a proof in which the number at a path is changed."""
    forged = copy.deepcopy(proof)
    inner = forged
    for name in path[:-1]:
        inner = inner[name]
    inner[path[-1]] = change(inner[path[-1]])
    return forged
