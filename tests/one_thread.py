"""Limits numpy to one thread on import: the workers of a test run, and the processes that they start, share
the cores.
"""

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")
