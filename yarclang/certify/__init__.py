"""The judge: reads the emitted controller text back and proves what the robot will do.

`certifying.py` is the entry point for a text with its program; `unsourced.py` judges a text without its
program. `read/` reads the text. `whole_text.py` checks the text as a whole, `flow.py` the actions between its
motions, such as waits and outputs. `motion/`, `blends/` and `bodies/` prove the motions; `stretches.py`
divides the text into stretches from rest to rest, which are proved one by one. `claims.py` defines what the
planner claims, `judged.py` compares these claims with the program, and `certificate.py` defines what is
proved. `pmac/` contains everything specific to texts for a Turbo PMAC.
"""

from yarclang.certify.certificate import Certificate, CommandCertificate, Load
from yarclang.certify.certifying import certify

__all__ = ["Certificate", "CommandCertificate", "Load", "certify"]
