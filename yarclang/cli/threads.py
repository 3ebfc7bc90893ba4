"""Set the number of threads for numpy's matrix products."""

from __future__ import annotations

import os

_SETTINGS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def one_for_products() -> None:
    """Limit numpy's matrix products to one thread, unless the environment sets another number. Call this
    before numpy is imported.

    The matrices here are small. With several threads, a sixth of the time for a long program is spent on
    waiting for the threads. Several cores are used by processes instead.
    """
    for name in _SETTINGS:
        os.environ.setdefault(name, "1")
