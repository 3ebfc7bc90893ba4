"""Set the number of threads for numpy's matrix products."""

from __future__ import annotations

import os

_SETTINGS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def one_for_products() -> None:
    """Limit numpy's matrix products to one thread, unless the environment sets another number. Call this
    before numpy is imported.

    The matrices here are small. With several threads, a sixth of a long program's time is spent on waiting
    between them. Several cores are used by processes instead.
    """
    for name in _SETTINGS:
        os.environ.setdefault(name, "1")
