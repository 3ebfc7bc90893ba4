"""Fixtures that the tests share: robots, independently computed numbers, and the flag that rewrites golden
files.
"""

import gc
import json
import shutil
import tempfile
from pathlib import Path

import one_thread  # noqa: F401 - before numpy is imported
import pytest
from hypothesis import settings

from yarclang.files import CACHE
from yarclang.robot.description import load_robot
from yarclang.runtime.transports.lock import SPACE

HERE = Path(__file__).parent
EXAMPLES = HERE.parent / "examples"


def pytest_addoption(parser):
    parser.addoption("--rewrite-golden", action="store_true", help="write the golden files anew")


def pytest_collection_modifyitems(items):
    """Run the browser's tests first: they are slow, and at the end of a run they would keep only one worker
    busy.
    """
    items.sort(key=lambda item: item.path.name != "test_browser.py")


@pytest.hookimpl(trylast=True)
def pytest_collection_finish():
    """Exclude objects that live for the whole session from garbage collection."""
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session", autouse=True)
def place_of_locks():
    """Use separate folders for locks, sockets and caches, because other processes on this computer may use
    the same addresses of robots.
    """
    # not tmp_path, because the path of a socket must be short
    path = Path(tempfile.mkdtemp(prefix="yarc-tests-"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_RUNTIME_DIR", str(path))
        patch.setenv(SPACE, path.name)
        patch.setenv(
            "YARCLANG_NO_CACHE", "1"
        )  # every test does its work itself, except for tests of the cache
        patch.setenv(CACHE, str(path / "cache"))  # an empty folder, without meshes from earlier runs
        yield path
    shutil.rmtree(path, ignore_errors=True)


@pytest.fixture
def rewrite_golden(request):
    return request.config.getoption("--rewrite-golden")


@pytest.fixture(scope="session")
def conformance():
    """Return a function that reads a conformance file by its name."""
    return lambda name: json.loads((HERE / "conformance" / f"{name}.json").read_text())


@pytest.fixture(scope="session")
def industrial6():
    return load_robot("INDUSTRIAL6").value


@pytest.fixture(scope="session")
def tracked():
    return load_robot("TRACKED_MANIPULATOR").value


settings.register_profile("yarclang", deadline=None)
settings.load_profile("yarclang")
