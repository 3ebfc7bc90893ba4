"""The judge: reads the emitted controller text back and proves what the robot will do.

`certifying.py` is its door, with the program; `unsourced.py` says what can be judged without. `read/` reads
the text. `whole_text.py` checks the text as a whole, `flow.py` what stands between its motions; `motion/`,
`blends/` and `bodies/` prove the motions, `stretches.py` stretch by stretch from rest to rest. `claims.py`
has what the planner claims, `certificate.py` what was proved. `pmac/` is all that only a text for a Turbo
PMAC says.
"""

from yarclang.certify.certificate import Certificate, CommandCertificate, Load
from yarclang.certify.certifying import certify

__all__ = ["Certificate", "CommandCertificate", "Load", "certify"]
