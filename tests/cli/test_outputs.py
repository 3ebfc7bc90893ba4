"""No output overwrites a source or another output.

Unusual names and folders cause findings, and no tracebacks.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc

GOOD = "P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n"


@pytest.fixture
def call(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sub").mkdir()
    for name in ("a.yarc", "sub/a.yarc", "a.txt", "prog.pmc", "a.png"):
        (tmp_path / name).write_text(GOOD)
    (tmp_path / "link.yarc").symlink_to("a.yarc")

    def run(*arguments, program=yarcc):
        done = CliRunner().invoke(program, [*arguments, "--robot", "INDUSTRIAL6"])
        assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
        return done

    return run


@pytest.mark.parametrize(
    "arguments",
    [
        ["a.yarc", "-o", "a.yarc"],
        ["link.yarc", "-o", "a.yarc"],
        ["a.yarc", "--certificate", "a.yarc"],
        ["prog.pmc"],
        ["a.yarc", "sub/a.yarc", "--out-dir", "out"],
        ["a.yarc", "a.txt"],
        ["a.yarc", "./a.yarc"],
        ["a.yarc", "--certificate", "a.pmc"],
        ["a.yarc", "-o", "x.pmc", "--certificate", "./x.pmc"],
        ["a.yarc", "--certificate", "-"],
    ],
)
def test_what_would_overwrite_is_wrong_usage(call, tmp_path, arguments):
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    assert call(*arguments).exit_code == 2
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_a_plot_never_overwrites_its_program(call):
    assert call("plot", "a.png", program=yarc).exit_code == 2
    assert Path("a.png").read_text() == GOOD


@pytest.mark.parametrize("name", ["größe mit blank.yarc", "zwei\nzeilen.yarc", "ohne", ".yarc"])
def test_odd_names_compile(call, name):
    Path(name).write_text(GOOD)
    done = call(name, "-o", "out.pmc")
    assert done.exit_code == 0, done.stderr
    assert Path("out.pmc").read_text().isascii()


@pytest.mark.parametrize("name", [".", "", "/", "sub"])
@pytest.mark.parametrize("program", ["yarcc", "plot"])
def test_folders_as_programs_are_findings(call, name, program):
    done = call(name) if program == "yarcc" else call(program, name, program=yarc)
    # a folder means all programs in it, so an output folder must be given
    if name:
        assert done.exit_code == 2
        assert "--out-dir" in done.stderr
        return
    assert done.exit_code == 1
    assert "Y0107" in done.stderr


def test_a_folder_s_texts_keep_its_folders(call):
    Path("all/deep").mkdir(parents=True)
    Path("all/deep/b.yarc").write_text(GOOD)
    Path("all/c.yarc").write_text(GOOD)
    assert call("all").exit_code == 2
    assert not [*Path("all").rglob("*.pmc")]
    assert call("all", "--out-dir", "texts").exit_code == 0
    assert sorted(map(str, Path("texts").rglob("*.pmc"))) == ["texts/c.pmc", "texts/deep/b.pmc"]


def test_results_are_written_both_or_not_at_all(call):
    Path("old.json").write_text("old")
    assert call("a.yarc", "-o", "sub", "--certificate", "c.json").exit_code == 1
    assert not Path("c.json").exists()
    assert (
        call("a.yarc", "-o", "new.pmc", "--certificate", "sub").exit_code == 1 or not Path("new.pmc").exists()
    )
    assert not Path("new.pmc").exists()


def test_a_full_device_is_a_finding(tmp_path):
    (tmp_path / "a.yarc").write_text(GOOD)
    command = [
        sys.executable,
        "-c",
        "from yarclang.cli.yarcc import main; main()",
        "a.yarc",
        "--robot",
        "INDUSTRIAL6",
        "-o",
        "-",
    ]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            command, cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode == 1
    assert "Y0107" in done.stderr
    assert "Traceback" not in done.stderr


def test_closed_standard_input_is_a_finding(tmp_path):
    command = [
        sys.executable,
        "-c",
        "from yarclang.cli.yarcc import main; main()",
        "-",
        "--robot",
        "INDUSTRIAL6",
    ]
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, check=False, preexec_fn=lambda: os.close(0)
    )
    assert done.returncode == 1
    assert "Traceback" not in done.stderr


def test_controller_text_as_a_program_is_one_finding(call):
    assert call("a.yarc", "-o", "x.pmc").exit_code == 0
    done = call("x.pmc", "-o", "y.pmc")
    assert done.exit_code == 1
    assert done.stderr.count("error") == 2  # the finding and the count
    assert "Y0108" in done.stderr


def test_a_wrong_robot_in_a_file_is_said_at_its_place(call):
    Path("r.yarc").write_text("ROBOT INDUSTRIAL\n" + GOOD)
    done = CliRunner().invoke(yarcc, ["r.yarc", "--format", "json"])
    (found,) = json.loads(done.stdout)["files"][0]["diagnostics"]
    assert (found["file"], found["line"], found["column"]) == ("r.yarc", 1, 7)
    Path("yarc.toml").write_text("robot = 'NOPE'\n")
    done = CliRunner().invoke(yarcc, ["a.yarc", "--format", "json"])
    (found,) = json.loads(done.stdout)["files"][0]["diagnostics"]
    assert found["file"].endswith("yarc.toml")
    assert found["line"] == 1
    Path("yarc.toml").write_text("robot = 'INDUSTRIAL6'\nstart = [1, 2]\n")
    done = CliRunner().invoke(yarcc, ["a.yarc", "--format", "json"])
    (found,) = json.loads(done.stdout)["files"][0]["diagnostics"]
    assert (found["code"], found["line"]) == ("Y1394", 2)


@pytest.mark.parametrize(
    ("program", "words", "expected"),
    [
        ("yarc", "yarc settings IND", "INDUSTRIAL6"),
        ("yarc", "yarc sim --robot IND", "INDUSTRIAL6"),
        ("yarc", "yarc explain Y060", "Y0601"),
        ("yarcc", "yarcc --robot TR", "TRACKED_MANIPULATOR"),
        ("yarcc", "yarcc a.y", "file"),
        ("yarc", "yarc check a.y", "file"),
        ("yarc", "yarc plot a.y", "file"),
    ],
)
def test_completion_offers(program, words, expected):
    """Completion is asked as bash does it; an answer `file` means that the shell completes paths."""
    environment = {**os.environ, f"_{program.upper()}_COMPLETE": "bash_complete", "COMP_WORDS": words}
    environment["COMP_CWORD"] = str(len(words.split()) - 1)
    command = [sys.executable, "-c", f"from yarclang.cli.{program} import main; main(prog_name='{program}')"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert expected in done.stdout


def test_the_hash_is_of_what_is_done(call):
    Path("b.yarc").write_text("p10 movej_lspb 10 0 0 0 0 0 [2000] (ms,deg) ! the same\n")
    call("a.yarc", "-o", "1.pmc")
    call("b.yarc", "-o", "2.pmc")
    hashes = [
        next(line for line in Path(f"{n}.pmc").read_text().splitlines() if line.startswith("; program"))
        for n in "12"
    ]
    assert hashes[0] == hashes[1]
