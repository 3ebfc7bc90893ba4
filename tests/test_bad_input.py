"""Tests of bad input of every kind: there is one clear finding at the right place, no output file and no
traceback.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

import yarclang
from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc

GOOD = "P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n"


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Return a function that compiles bytes as a file. It returns the exit status, the findings, and True if
    there is output.
    """
    monkeypatch.chdir(tmp_path)

    def compile_bytes(content, *arguments, robot="INDUSTRIAL6"):
        (tmp_path / "p.yarc").write_bytes(content if isinstance(content, bytes) else content.encode())
        options = ["p.yarc", "--format", "json", *arguments, *(["--robot", robot] if robot else [])]
        done = CliRunner().invoke(yarcc, options)
        assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
        (report,) = json.loads(done.stdout)["files"]
        return done.exit_code, report["diagnostics"], (tmp_path / "p.pmc").exists()

    return compile_bytes


def test_a_good_program_is_written(run):
    assert run(GOOD) == (0, [], True)


@pytest.mark.parametrize(
    ("content", "code", "line", "column"),
    [
        (b"", "Y0104", 1, 1),
        (b"! only a remark\n", "Y0104", 1, 1),
        (b"P0010 STOP\nP0020 M\x00VEJ\n", "Y0103", 2, 8),
        (b"P0010 STOP ! caf\xe9\n", "Y0103", 1, 17),
        (b"\xff\xfeP\x000\x00", "Y0103", 1, 1),
        (b"\x7fELF\x02\x01", "Y0103", 1, 1),
        (b"P0010 MOVEJ " + b"0 " * 600_000, "Y0106", 1, 1),
        (b"x" * 1_048_576, "Y0106", 1, 1),
    ],
    ids=["empty", "comments", "nul", "latin1", "utf16", "elf", "long list", "long word"],
)
def test_what_is_no_program(run, content, code, line, column):
    status, found, written = run(content)
    assert (status, written) == (1, False)
    assert [(one["code"], one["line"], one["column"]) for one in found] == [(code, line, column)]
    assert len(found[0]["message"]) < 300


def test_crlf_byte_order_mark_and_utf8_comments_are_fine(run):
    assert run(b"\xef\xbb\xbf" + "! Größe\r\n".encode() + GOOD.replace("\n", "\r\n").encode()) == (
        0,
        [],
        True,
    )


def test_many_faults_in_one_file_are_one_finding_each(run):
    lines = [
        "P0010 MOVEK 0 0 0 0 0 0 [5] (deg,s)",
        "P0020 MOVEJ 0 0 0 0 0 [5] (deg,s)",
        "P0030 MOVEJ 0 0 0 0 0 0 [5] (s)",
        "P0040 MOVEL {TPC} 0 1174.4 1176 0 0 0 [5] (mm,deg,s) {B}",
        "P0050 MOVEJ 0 0 30-5 0 0 0 [5] (deg,s)",
        "P0060 MOVEJ 0 0 0 0 0 0 [-5] (deg,s)",
        "P0070 MOVEJ 0 0 0 0 0 0 [5 (deg,s)",
        "P0070 MOVEJ_RPY {TCP} 0 4000 1176 0 0 0 [5] (mm,deg,s) {B}",
        "P0080 MOVEJ 200 0 0 0 0 0 [5] (deg,s)",
        "P0090 MOVEJ 0 -10 -40 0 50 0 [5] (deg,s)",
        "P0100 MOVEJ 0 -10 40 0 50 0 [0.5] (deg,s)",
        "P0110 MOVEL {TCP} 0 5000 1176 0 0 0 [5] (mm,deg,s) {B}",
    ]
    status, found, written = run("\n".join(lines) + "\n")
    assert (status, written) == (1, False)
    assert [(one["line"], one["code"]) for one in found] == [
        (1, "Y0202"),
        (2, "Y0401"),
        (3, "Y0304"),
        (4, "Y0301"),
        (5, "Y0402"),
        (6, "Y0407"),
        (7, "Y0102"),
        (8, "Y0501"),
        (9, "Y0502"),
        (11, "Y0601"),
        (12, "Y0501"),
    ]


# along the path: both ends can be reached, but not the path between them

NEAR = "START 0 -6.158742074 -46.519197172 0 52.677939245 0 (deg)\nDEFAULT {TCP} [20] (mm,deg,s) {B}\n"


def test_a_line_that_leaves_the_workspace_says_where_and_by_how_much(run):
    """Half way, the tool points inwards, and the wrist is 338 mm farther out than the tool: at y 1738, z 1500
    mm.
    """
    program = "P0010 MOVEJ_RPY 0 1400 1500 0 0 95\nP0020 MOVEL 0 1400 1500 0 0 -95\n"
    status, found, written = run(NEAR + program)
    assert (status, written) == (1, False)
    assert [(one["code"], one["line"]) for one in found] == [("Y0503", 4)]
    wrist = ((1.738 - 0.2) ** 2 + (1.5 - 0.679) ** 2) ** 0.5
    reach = 0.89 + (0.6364**2 + 0.195**2) ** 0.5
    assert f"by up to {(wrist - reach) * 1e3:.0f} mm" in found[0]["message"]
    assert "% of the path" in found[0]["message"]


def test_a_line_past_the_robot_s_own_axis_needs_another_configuration(run):
    program = "P0010 MOVEJ_RPY 700 100 800 0 0 -90\nP0020 MOVEL -700 100 800 0 0 80\n"
    status, found, written = run(NEAR + program)
    assert (status, written) == (1, False)
    assert [(one["code"], one["line"]) for one in found] == [("Y0801", 4)]
    assert "% of the path" in found[0]["message"]


def test_a_line_that_takes_a_joint_out_of_its_limits_says_which(run):
    program = "P0010 MOVEJ_RPY 15 985 802 0 0 -1\nP0020 MOVEL 645 536 553 0 0 -50\n"
    status, found, _ = run(NEAR + program)
    assert status == 1
    assert [(one["code"], one["line"]) for one in found] == [("Y0504", 4)]
    assert "J5" in found[0]["message"]


def test_a_line_beside_a_singularity_has_no_time_that_works(run):
    program = "START 0 0 0 0 0.0000001 0 (deg)\nP0010 DMOVE {TCP} 50 0 0 0 0 0 [MIN] (mm,deg) {B}\n"
    status, found, _ = run(program)
    assert status == 1
    assert [one["code"] for one in found] == ["Y0604"]


def test_a_line_from_the_straight_wrist_sideways_is_singular(run):
    status, found, _ = run("P0010 DMOVE {TCP} 50 0 0 0 0 0 [5] (mm,deg,s) {B}\n")
    assert status == 1
    assert [one["code"] for one in found] == ["Y0701"]
    assert "J4 would have to jump by 90 deg" in found[0]["message"]


def test_a_line_straight_through_the_straight_wrist_is_fine(run):
    program = (
        "P0010 DMOVE {TCP} 0 0 -200 0 0 0 [5] (mm,deg,s) {B}\n"
        "P0020 DMOVE {TCP} 0 0 200 0 0 0 [5] (mm,deg,s) {B}\n"
    )
    assert run(program)[:2] == (0, [])


# options and settings


@pytest.mark.parametrize(
    ("tm", "code"),
    [("5.0001", "Y1101"), ("80", "Y1102"), ("5000", "Y1102"), ("1", "Y1103"), ("3.98", "Y1103")],
)
def test_segment_times_that_the_controller_does_not_take(run, tm, code):
    status, found, written = run(GOOD, "--tm", tm)
    assert (status, [one["code"] for one in found], written) == (1, [code], False)


def test_no_robot_lists_the_robots(run):
    status, found, _ = run(GOOD, robot=None)
    assert (status, [one["code"] for one in found]) == (1, ["Y1391"])
    assert "INDUSTRIAL6" in found[0]["help"]
    assert "TRACKED_MANIPULATOR" in found[0]["help"]


def test_another_robot_than_the_program_s_is_refused(run):
    status, found, _ = run("ROBOT TRACKED_MANIPULATOR\n" + GOOD)
    assert (status, [one["code"] for one in found]) == (1, ["Y1392"])
    assert run("ROBOT INDUSTRIAL6\n" + GOOD)[:2] == (0, [])
    assert run("ROBOT INDUSTRIAL6\n" + GOOD, robot=None)[:2] == (0, [])


def test_an_unknown_robot_gets_a_suggestion(run):
    status, found, _ = run(GOOD, robot="INDUSTRAL6")
    assert (status, len(found)) == (1, 1)
    assert "INDUSTRIAL6" in found[0]["message"] + found[0]["help"]


@pytest.mark.parametrize("start", ["0,0,0", "0,0,0,0,0,0,0", "171,0,0,0,0,0"])
def test_a_start_that_is_none(run, start):
    status, found, _ = run(GOOD, "--start", start)
    assert (status, [one["code"] for one in found]) == (1, ["Y1394"])


@pytest.mark.parametrize(
    ("toml", "codes"),
    [
        ("robot = 'INDUSTRIAL6'\n", []),
        ("robot = 'INDUSTRIAL6'\nstart = [5, 0, 0, 0, 0, 0]\n", []),
        ("robott = 'INDUSTRIAL6'\n", ["Y1393"]),
        ("robot = 6\nstart = 'x'\n", ["Y1393", "Y1393"]),
        ("robot = \n", ["Y1393"]),
        ("robot = 'INDUSTRIAL6'\nstart = [1, 2]\n", ["Y1394"]),
    ],
)
def test_yarc_toml(run, tmp_path, toml, codes):
    (tmp_path / "yarc.toml").write_text(toml)
    status, found, _ = run(GOOD, robot=None)
    assert [one["code"] for one in found] == codes
    assert status == (1 if codes else 0)


def test_yarc_toml_says_where_the_robot_stands(run, tmp_path):
    (tmp_path / "yarc.toml").write_text("robot = 'INDUSTRIAL6'\nstart = [5, 0, 0, 0, 0, 0]\n")
    run(GOOD, robot=None)
    assert "\nX5Y0Z0A0B0C0\nDWELL0\n" in (tmp_path / "p.pmc").read_text()
    run("START 7 0 0 0 0 0 (deg)\n" + GOOD, robot=None)
    assert "\nX7Y0Z0A0B0C0\nDWELL0\n" in (tmp_path / "p.pmc").read_text()
    run("START 7 0 0 0 0 0 (deg)\n" + GOOD, "--start", "8,0,0,0,0,0", robot=None)
    assert "\nX8Y0Z0A0B0C0\nDWELL0\n" in (tmp_path / "p.pmc").read_text()


def test_missing_and_unwritable_files(tmp_path):
    runner = CliRunner()
    missing = runner.invoke(yarcc, [str(tmp_path / "none.yarc"), "--robot", "INDUSTRIAL6"])
    assert missing.exit_code == 1
    assert "Y0107" in missing.stderr
    program = tmp_path / "p.yarc"
    program.write_text(GOOD)
    folder = tmp_path / "taken"
    folder.write_text("a file, not a folder")
    refused = runner.invoke(yarcc, [str(program), "--robot", "INDUSTRIAL6", "--out-dir", str(folder / "x")])
    assert refused.exit_code == 1
    assert "Y0107" in refused.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["p.yarc", "--tm", "fast"],
        ["p.yarc", "--tm", "-5"],
        ["p.yarc", "--tolerance", "0"],
        ["p.yarc", "--tolerance", "1,2,3"],
        ["p.yarc", "--start", "a,b"],
        ["p.yarc", "--start", "nan,0,0,0,0,0"],
        ["p.yarc", "--target", "plc"],
        ["p.yarc", "q.yarc", "-o", "x.pmc"],
        ["p.yarc", "p.yarc"],
        ["p.yarc", "-o", "x.pmc", "--out-dir", "y"],
        ["p.yarc", "-o", "-", "--format", "json"],
        ["p.yarc", "--nonsense"],
    ],
)
def test_wrong_usage_is_status_2(arguments):
    assert CliRunner().invoke(yarcc, arguments).exit_code == 2


def test_strict_counts_a_warning_as_an_error(run, tmp_path):
    program = "P0020 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\nP0010 STOP\n"
    assert run(program)[0] == 0
    (tmp_path / "p.pmc").unlink()
    status, _, written = run(program, "--strict")
    assert (status, written) == (1, False)


def test_an_older_output_is_left_and_named(tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(GOOD)
    runner = CliRunner()
    assert runner.invoke(yarcc, [str(program), "--robot", "INDUSTRIAL6"]).exit_code == 0
    before = (tmp_path / "p.pmc").read_bytes()
    program.write_text("P0010 MOVEK\n")
    done = runner.invoke(yarcc, [str(program), "--robot", "INDUSTRIAL6"])
    assert done.exit_code == 1
    assert "existed before and is unchanged" in done.stderr
    assert (tmp_path / "p.pmc").read_bytes() == before


def test_unknown_commands_of_yarc_get_a_suggestion():
    done = CliRunner().invoke(yarc, ["chek"])
    assert done.exit_code == 2
    assert "Did you mean check?" in done.output


# paths that are no file, and files without an end


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda path: path.mkdir(), "it is a folder, not a file"),
        (os.mkfifo, "it is a pipe, not a file"),
        (lambda path: path.symlink_to("/dev/zero"), "it is a device, not a file"),
        (lambda path: path.symlink_to(path), "too many levels of symbolic links"),
        (lambda path: truncated(path, 100_000_000), "it has 100,000,000 bytes; at most 20,000,000 are read"),
    ],
    ids=["folder", "pipe", "device", "circle", "100 MB"],
)
def test_one_error_at_once_at_every_door(tmp_path, monkeypatch, make, said):
    monkeypatch.chdir(tmp_path)
    make(tmp_path / "p.yarc")
    for main, arguments, status in (
        (yarcc, ["p.yarc"], 1),
        (yarc, ["check", "--no-plan", "p.yarc"], 1),
        (yarc, ["fmt", "p.yarc"], 2),
        (yarc, ["inspect", "p.yarc", "P0010"], 1),
        (yarc, ["plot", "p.yarc"], 1),
    ):
        if "folder" in said and (main is yarcc or arguments[0] in {"check", "fmt", "plot"}):
            continue  # for these commands, a folder stands for all programs in it
        done = CliRunner().invoke(main, arguments)
        assert done.exit_code == status, done.output
        assert f"error Y0107: p.yarc can't be read: {said}" in done.stderr
        assert done.stderr.count("Y0107") == 1


def truncated(path, size):
    with path.open("wb") as file:
        file.truncate(size)


def test_standard_input_without_end(tmp_path):
    command = [sys.executable, "-c", "from yarclang.cli.yarc import main; main()", "check", "--no-plan", "-"]
    with Path("/dev/zero").open("rb") as zeros:
        done = subprocess.run(command, stdin=zeros, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 1
    assert "error Y0107: <stdin> can't be read: it has more than 20,000,000 bytes" in done.stderr


def test_a_text_of_any_length_is_one_finding():
    (found,) = yarclang.parse("P0010 STOP\n" * 2_000_000).diagnostics
    assert (found.code, "22,000,000 characters" in found.message) == ("Y0106", True)


@pytest.mark.parametrize(
    "words",
    [["check", "--no-plan"], ["fmt"], ["fmt", "--diff"], ["check", "--no-plan", "--format", "json"],
        ["check", "--no-plan", "--format", "junit"],
     ["check", "--no-plan", "--format", "sarif"], ["check", "--no-plan", "--format", "github"],
         ["check", "--fix", "--diff"]],
    ids=" ".join,
)  # fmt: skip
@pytest.mark.parametrize("text", ["p0010 stop\n", "p0010 movek\n", "P0010 MOVEJ ["])
def test_a_file_whose_name_is_no_text(tmp_path, words, text):
    path = tmp_path / os.fsdecode(b"p\xff\xfe.yarc")
    path.write_text(text)
    command = [sys.executable, "-c", "from yarclang.cli.yarc import main; main()", *words, str(path)]
    env = {**os.environ, "PYTHONIOENCODING": "utf-8:strict"}
    done = subprocess.run(command, capture_output=True, check=False, env=env)
    assert done.returncode in {0, 1, 2}
    assert b"Traceback" not in done.stderr, done.stderr
