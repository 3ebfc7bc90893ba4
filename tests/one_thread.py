"""Importing this leaves numpy one thread: the workers of a test run share the cores, and so do the
processes that they start.
"""

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")
