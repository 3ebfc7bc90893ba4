"""How many threads numpy's matrix products may have."""

from __future__ import annotations

import os

_SETTINGS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def one_for_products() -> None:
    """Leave matrix products one thread, unless the environment says otherwise; before numpy is imported.

    Ours are small: with more threads these wait for each other, a sixth of the time that a long program takes. Cores are used by processes.
    """
    for name in _SETTINGS:
        os.environ.setdefault(name, "1")
