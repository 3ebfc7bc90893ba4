"""What the tests share: robots, the numbers worked out independently, and the flag that rewrites goldens."""

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
    """The browser's tests come first: they are slow, and at the end only one of the workers would be busy
    with them.
    """
    items.sort(key=lambda item: item.path.name != "test_browser.py")


@pytest.hookimpl(trylast=True)
def pytest_collection_finish():
    """What is there for the whole session isn't looked through for garbage again and again."""
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session", autouse=True)
def place_of_locks():
    """Locks and sockets of robots by themselves: others on this computer, tests too, may hold the same
    addresses.
    """
    path = Path(tempfile.mkdtemp(prefix="yarc-tests-"))  # not tmp_path: the path of a socket must be short
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_RUNTIME_DIR", str(path))
        patch.setenv(SPACE, path.name)
        patch.setenv(
            "YARCLANG_NO_CACHE", "1"
        )  # every test does its work itself; those of the cache say otherwise
        patch.setenv(CACHE, str(path / "cache"))  # and no meshes that somebody has kept
        yield path
    shutil.rmtree(path, ignore_errors=True)


@pytest.fixture
def rewrite_golden(request):
    return request.config.getoption("--rewrite-golden")


@pytest.fixture(scope="session")
def conformance():
    """A function: the content of a conformance file by its name."""
    return lambda name: json.loads((HERE / "conformance" / f"{name}.json").read_text())


@pytest.fixture(scope="session")
def industrial6():
    return load_robot("INDUSTRIAL6").value


@pytest.fixture(scope="session")
def tracked():
    return load_robot("TRACKED_MANIPULATOR").value


settings.register_profile("yarclang", deadline=None)
settings.load_profile("yarclang")
