"""yarcc and yarc as their users call them."""

import io
import json
import subprocess
import sys

import pytest
from click.testing import CliRunner
from conftest import EXAMPLES

from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc

GOOD = "P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n"
LISTING = str(EXAMPLES / "01_listing4.yarc")


@pytest.fixture
def runner():
    return CliRunner()


def test_one_file_beside_its_source(runner, tmp_path):
    (tmp_path / "p.yarc").write_text(GOOD)
    done = runner.invoke(yarcc, [str(tmp_path / "p.yarc"), "--robot", "INDUSTRIAL6"])
    assert done.exit_code == 0
    assert (tmp_path / "p.pmc").read_text().endswith("CLOSE\n")
    assert "P0010" in done.stdout
    assert "certified" in done.stdout


def test_several_files_into_a_folder(runner, tmp_path):
    for name in "ab":
        (tmp_path / f"{name}.yarc").write_text(GOOD)
    (tmp_path / "bad.yarc").write_text("P0010 MOVEK\n")
    files = [str(tmp_path / f"{name}.yarc") for name in ("a", "bad", "b")]
    done = runner.invoke(
        yarcc, [*files, "--robot", "INDUSTRIAL6", "--out-dir", str(tmp_path / "new" / "out")]
    )
    assert done.exit_code == 1
    assert sorted(path.name for path in (tmp_path / "new" / "out").iterdir()) == ["a.pmc", "b.pmc"]
    assert "bad.yarc:1:7: error Y0202" in done.stderr


def test_standard_input_to_standard_output(runner):
    done = runner.invoke(yarcc, ["-", "--robot", "INDUSTRIAL6"], input=GOOD)
    assert done.exit_code == 0
    assert done.stdout.startswith("; yarcc")
    assert done.stdout.endswith("CLOSE\n")
    assert "certified" in done.stderr


def test_the_certificate_as_json(runner, tmp_path):
    out, certificate = tmp_path / "x.pmc", tmp_path / "x.json"
    done = runner.invoke(
        yarcc, [LISTING, "--robot", "INDUSTRIAL6", "-o", str(out), "--certificate", str(certificate)]
    )
    assert done.exit_code == 0
    data = json.loads(certificate.read_text())
    assert data["duration_s"] == pytest.approx(40.0)
    assert [command["index"] for command in data["commands"]] == ["P0001", "P0002"]
    assert data["deviation"]["angle_deg"] < 0.002


def test_json_on_standard_output(runner, tmp_path):
    done = runner.invoke(
        yarcc, [LISTING, "--robot", "INDUSTRIAL6", "-o", str(tmp_path / "x.pmc"), "--format", "json"]
    )
    (report,) = json.loads(done.stdout)["files"]
    assert [one["code"] for one in report["diagnostics"]] == ["Y0505"]
    assert report["certificate"]["duration_s"] == pytest.approx(40.0)


def test_a_smaller_tolerance_takes_shorter_segments(runner, tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(
        "DEFAULT {TCP} (mm,deg,s) {B}\n"
        "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [20]\n"
        "P0020 MOVEL 150 1074.4 1326 10 -5 20 [2.5]\n"
    )
    segments = []
    for tolerance in ("0.02", "0.0001,0.00001"):
        done = runner.invoke(
            yarcc, [str(program), "--robot", "INDUSTRIAL6", "--tolerance", tolerance, "--format", "json"]
        )
        assert done.exit_code == 0, done.output
        command = json.loads(done.stdout)["files"][0]["certificate"]["commands"][1]
        segments.append(command["segments"])
        assert command["deviation"]["position_mm"] <= float(tolerance.split(",")[0])
    assert segments[1] > segments[0]


def test_a_tolerance_that_no_segment_time_holds_is_refused(runner, tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(
        "DEFAULT {TCP} (mm,deg,s) {B}\n"
        "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [20]\n"
        "P0020 MOVEL 150 1074.4 1326 10 -5 20 [2.5]\n"
    )
    done = runner.invoke(yarcc, [str(program), "--robot", "INDUSTRIAL6", "--tolerance", "1e-9,1e-9"])
    assert done.exit_code == 1
    assert "Y0602" in done.stderr
    assert not (tmp_path / "p.pmc").exists()


def test_carets_stand_under_the_fault(runner):
    done = runner.invoke(
        yarc, ["check", "-", "--robot", "INDUSTRIAL6"], input="P0010 MOVEJ 0 0 30-5 0 0 0 [5] (deg,s)\n"
    )
    lines = done.stderr.splitlines()
    assert lines[0].startswith("<stdin>:1:17: error Y0402")
    assert lines[1].index("30-5") == lines[2].index("^^^^")
    assert lines[2].count("^") == 4


def test_colours_only_on_a_terminal(runner):
    done = runner.invoke(yarc, ["check", "-", "--robot", "INDUSTRIAL6"], input="P0010 MOVEK\n")
    assert "\x1b[" not in done.stderr
    coloured = runner.invoke(
        yarc, ["check", "-", "--robot", "INDUSTRIAL6"], input="P0010 MOVEK\n", color=True
    )
    assert "\x1b[" in coloured.stderr


def test_check_writes_nothing_and_counts(runner, tmp_path):
    (tmp_path / "p.yarc").write_text("P0010 MOVEK\n")
    done = runner.invoke(yarc, ["check", str(tmp_path / "p.yarc"), LISTING, "--robot", "INDUSTRIAL6"])
    assert done.exit_code == 1
    assert "2 files checked: 1 error" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["p.yarc"]


def test_explain_knows_every_code_and_name(runner):
    done = runner.invoke(yarc, ["explain", "y0601"])
    assert done.exit_code == 0
    assert "time-too-short" in done.stdout
    assert "Better" in done.stdout
    assert runner.invoke(yarc, ["explain", "time-too-short"]).stdout == done.stdout
    assert runner.invoke(yarc, ["explain", "Y9999"]).exit_code == 1
    assert "Y1151" in runner.invoke(yarc, ["explain"]).stdout


def test_robots_and_settings(runner, tmp_path):
    listed = runner.invoke(yarc, ["robot", "list"])
    assert [line.split()[0] for line in listed.stdout.splitlines()] == ["INDUSTRIAL6", "TRACKED_MANIPULATOR"]
    shown = runner.invoke(yarc, ["robot", "list", "industrial6"])
    assert "-170" in shown.stdout
    assert runner.invoke(yarc, ["robot", "list", "nothing"]).exit_code == 1
    settings = runner.invoke(yarc, ["settings", "INDUSTRIAL6"])
    assert "#3->29308.7083Y+29308.7083Z" in settings.stdout
    assert runner.invoke(yarc, ["settings", "nothing"]).exit_code == 1


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion(runner, shell):
    done = runner.invoke(yarc, ["completion", shell])
    assert done.exit_code == 0
    assert "_YARCC_COMPLETE" in done.stdout
    assert "_YARC_COMPLETE" in done.stdout


def test_versions(runner):
    assert runner.invoke(yarcc, ["--version"]).stdout.startswith("yarcc 0.")
    assert runner.invoke(yarc, ["--version"]).stdout.startswith("yarc 0.")


def test_the_commands_start_without_a_planner():
    """What --help needs doesn't import numpy, Pinocchio, Lark or rich."""
    code = "import sys, yarclang.cli.yarcc, yarclang.cli.yarc; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert not {"numpy", "pinocchio", "scipy", "lark", "rich", "pydantic", "matplotlib"} & set(loaded)


@pytest.mark.parametrize(
    ("words", "needless"),
    [
        ("yarcc --help", "numpy pydantic lark importlib.metadata"),
        ("yarc fmt --check FILE", "numpy pydantic lark importlib.metadata"),
        ("yarcc --robot INDUSTRIAL6 -o OUT FILE", "lark matplotlib toppra ompl rich"),
    ],
)
def test_what_a_start_does_not_import(tmp_path, words, needless):
    """Each of these modules takes 10 ms or more, and isn't needed to compile Listing 4."""
    command, *arguments = words.split()
    known = {"FILE": str(EXAMPLES / "01_listing4.yarc"), "OUT": str(tmp_path / "out.pmc")}
    arguments = [known.get(word, word) for word in arguments]
    code = (
        "import atexit, sys\n"
        "atexit.register(lambda: print(*sys.modules, file=sys.stderr))\n"
        f"from yarclang.cli.{command} import main\n"
        f"main({arguments!r})"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    assert set(needless.split()) & set(ended.stderr.splitlines()[-1].split()) == set()


def test_long_work_shows_progress_on_a_terminal(monkeypatch):
    from yarclang.cli import work

    class Terminal(io.StringIO):
        def isatty(self):
            return True

    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(work, "_SILENT", 0.0)
    with work.Progress() as progress:
        progress("planning", 1, 2)
    assert "planning" in terminal.getvalue()
    monkeypatch.setattr(work, "_SILENT", 1e9)
    with work.Progress() as progress:
        progress("planning", 1, 2)
    assert terminal.getvalue().count("certifying") == 0


def test_the_certificate_is_written_in_pieces_as_it_was_written_whole(runner, tmp_path):
    (tmp_path / "ü.yarc").write_text(GOOD + "P0020 MOVEJ 0 0 0 0 0 0 [2] (deg,s)\n")
    (tmp_path / "bad.yarc").write_text("P0010 MOVEK\n")
    names = [str(tmp_path / name) for name in ("ü.yarc", "bad.yarc")]
    certificate = tmp_path / "x.json"
    done = runner.invoke(yarcc, [*names, "--robot", "INDUSTRIAL6", "--format", "json"])
    told = json.loads(done.stdout)
    assert done.stdout == json.dumps(told, indent=2, ensure_ascii=False) + "\n"
    assert [bool(one["certificate"]) for one in told["files"]] == [True, False]
    done = runner.invoke(yarcc, [names[0], "--robot", "INDUSTRIAL6", "--certificate", str(certificate)])
    assert done.exit_code == 0
    data = json.loads(certificate.read_text())
    assert certificate.read_text() == json.dumps(data, indent=2) + "\n"
    assert data == told["files"][0]["certificate"]
    assert len(data["commands"]) == 2


def test_of_many_findings_alike_the_first_are_shown(runner, tmp_path):
    path = tmp_path / "p.yarc"
    path.write_text(GOOD + "".join(f"FRAME {{G{n}}} 0 0 0 0 0 0 (mm,deg) {{B}}\n" for n in range(31)))
    robot = ["--robot", "INDUSTRIAL6"]
    done = runner.invoke(yarcc, [str(path), *robot])
    assert done.exit_code == 0
    assert done.stderr.count("note Y0216") == 20
    assert f"and 11 more notes Y0216 in {path}, lines 22 to 32" in done.stderr
    every = runner.invoke(yarc, ["check", str(path), *robot, "--format", "json"])
    assert every.stdout.count('"Y0216"') == 31
    wanted = runner.invoke(yarc, ["check", str(path), *robot, "--max-findings", "25"])
    assert wanted.stderr.count("note Y0216") == 25
