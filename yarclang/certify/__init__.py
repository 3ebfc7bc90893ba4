"""The judge: reads the emitted controller text back and proves what the robot will do.

`certifying.py` is the entry point, with a program; `unsourced.py` handles a text without its program. `read/`
reads the text. `whole_text.py` checks the text as a whole, `flow.py` the actions between its motions.
`motion/`, `blends/` and `bodies/` prove the motions; `stretches.py` divides the text into stretches from rest
to rest for these proofs. `claims.py` defines the claims of the planner, `certificate.py` the proved results.
`pmac/` contains everything specific to texts for a Turbo PMAC.
"""

from yarclang.certify.certificate import Certificate, CommandCertificate, Load
from yarclang.certify.certifying import certify

__all__ = ["Certificate", "CommandCertificate", "Load", "certify"]
