"""Number of threads for numpy's matrix products."""

from __future__ import annotations

import os

_SETTINGS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def one_for_products() -> None:
    """Limit matrix products to one thread, unless the environment says otherwise. Call it before numpy is
    imported.

    Our matrices are small: several threads would wait for each other for a sixth of a long program's time.
    Processes use the cores.
    """
    for name in _SETTINGS:
        os.environ.setdefault(name, "1")
