"""Matrix products use one thread, unless the environment says otherwise."""

import os

from yarclang.cli.threads import one_for_products


def test_products_have_one_thread_unless_the_environment_says_otherwise(monkeypatch):
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "3")
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    one_for_products()
    found = os.environ["OPENBLAS_NUM_THREADS"], os.environ["OMP_NUM_THREADS"]
    monkeypatch.undo()
    assert found == ("3", "1")
