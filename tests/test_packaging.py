"""Tests of the content of the built distributions."""

import shutil
import subprocess
import sys
import tarfile
import zipfile
from email.parser import Parser
from importlib import import_module
from pathlib import Path

import pytest
import yaml

from yarclang import __version__

ROOT = Path(__file__).resolve().parents[1]


def files_of(folder: str) -> set[str]:
    """Return the files of a folder of the repository, without caches of Python."""
    paths = (path for path in (ROOT / folder).rglob("*") if path.is_file())
    return {path.relative_to(ROOT).as_posix() for path in paths if "__pycache__" not in path.parts}


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-t", "sdist", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    return folder


@pytest.fixture(scope="module")
def wheel(built: Path) -> zipfile.ZipFile:
    (path,) = built.glob("*.whl")
    return zipfile.ZipFile(path)


@pytest.fixture(scope="module")
def wheel_files(wheel: zipfile.ZipFile) -> set[str]:
    return set(wheel.namelist())


@pytest.fixture(scope="module")
def sdist_files(built: Path) -> set[str]:
    (path,) = built.glob("*.tar.gz")
    with tarfile.open(path) as archive:
        return {name.partition("/")[2] for name in archive.getnames()}


def test_wheel_has_the_package_and_nothing_else(wheel_files: set[str]):
    package = {name for name in wheel_files if not name.split("/")[0].endswith(".dist-info")}
    assert package == files_of("yarclang") | {f"yarclang/{name}" for name in files_of("stdlib")}


def test_wheel_has_what_is_not_python(wheel_files: set[str]):
    wanted = {"yarclang/grammar.lark", "yarclang/py.typed", "yarclang/stdlib/robots/industrial6/robot.toml"}
    assert wanted <= wheel_files


def test_wheel_has_the_licence(wheel_files: set[str]):
    assert any(name.endswith(".dist-info/licenses/LICENSE") for name in wheel_files)


def test_entry_points_exist(wheel: zipfile.ZipFile):
    (name,) = (name for name in wheel.namelist() if name.endswith("entry_points.txt"))
    lines = [line for line in wheel.read(name).decode().splitlines() if "=" in line]
    assert {line.split(" = ")[0] for line in lines} == {"yarcc", "yarc"}
    for line in lines:
        module, function = line.split(" = ")[1].split(":")
        assert callable(getattr(import_module(module), function))


def test_extras(wheel: zipfile.ZipFile):
    (name,) = (name for name in wheel.namelist() if name.endswith(".dist-info/METADATA"))
    assert set(Parser().parsestr(wheel.read(name).decode()).get_all("Provides-Extra", [])) == {
        "test",
        "bags",
        "fleet",
        "dev",
        "docs",
        "pendant",
        "view",
        "xacro",
    }


def test_sdist_builds_and_tests_itself(sdist_files: set[str]):
    wanted = files_of("yarclang") | files_of("stdlib") | files_of("tests") | files_of("examples")
    assert wanted <= sdist_files
    assert {"pyproject.toml", "README.md", "LICENSE", "CHANGELOG.md", "mkdocs.yml"} <= sdist_files
    assert {"SECURITY.md", "CITATION.cff"} <= sdist_files


def test_another_build_has_the_same_bytes(built: Path, tmp_path: Path):
    """A build in another folder at another time has the same bytes, so that anybody can verify a release."""
    copy = tmp_path / "copy"
    left_out = shutil.ignore_patterns(
        ".git",
        "node_modules",
        "__pycache__",
        "build",
        "dist",
        ".*_cache",
        ".venv",
        ".hypothesis",
        "*.vsix",
        "out",
    )
    shutil.copytree(ROOT, copy, ignore=left_out, copy_function=shutil.copy)  # the copied files have new times
    command = [
        sys.executable,
        "-m",
        "hatchling",
        "build",
        "-t",
        "wheel",
        "-t",
        "sdist",
        "-d",
        str(tmp_path / "dist"),
    ]
    subprocess.run(command, cwd=copy, check=True, capture_output=True)
    again = {path.name: path.read_bytes() for path in (tmp_path / "dist").iterdir()}
    assert len(again) == 2
    assert {path.name: path.read_bytes() for path in built.iterdir()} == again


def test_the_citation_is_of_this_version():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert cited["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= set(cited)
    assert cited["version"] == __version__
    assert cited["license"] == "Apache-2.0"
    assert [author["family-names"] for author in cited["references"][0]["authors"]] == [
        "Su",
        "Gao",
        "Wu",
        "Dong",
        "Wang",
        "Du",
    ]


def test_sdist_has_nothing_stray(sdist_files: set[str]):
    folders = {name.split("/")[0] for name in sdist_files if "/" in name}
    assert folders <= {
        "benchmarks",
        "docs",
        "editors",
        "examples",
        "requirements",
        "stdlib",
        "tests",
        "yarclang",
    }
