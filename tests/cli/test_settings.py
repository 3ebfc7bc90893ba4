"""`yarc settings` writes only proved settings, and judges files.

No command moves a robot by settings that aren't proved.
"""

import json
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from yarclang.backend_pmac import settings as writer
from yarclang.backend_pmac.settings import settings_text
from yarclang.cli.yarc import main

ROOT = Path(__file__).resolve().parents[2]


def yarc(*arguments, status=0, content=None):
    result = CliRunner().invoke(main, [str(one) for one in arguments], input=content)
    assert result.exit_code == status, result.output
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result


@pytest.fixture
def wrong(monkeypatch):
    """Make the writer of settings ignore the couplings."""
    rate = writer._motor_rate
    monkeypatch.setattr(writer, "_motor_rate", lambda robot, joint_rate: 2.0 * rate(robot, joint_rate))


@pytest.mark.parametrize("robot", ["INDUSTRIAL6", "TRACKED_MANIPULATOR"])
def test_it_prints_the_text(robot, industrial6, tracked):
    value = {"INDUSTRIAL6": industrial6, "TRACKED_MANIPULATOR": tracked}[robot]
    result = yarc("settings", robot)
    assert result.stdout == settings_text(value)
    assert result.stderr == ""


def test_what_is_not_proved_is_not_printed(wrong):
    result = yarc("settings", "INDUSTRIAL6", status=1)
    assert result.stdout == ""
    assert (
        "yarc settings INDUSTRIAL6:34:1: error Y1174: I115=12.2558: an abort brakes J1 with up to 480 deg/s2"
        in result.stderr
    )
    assert "help: correct robot.toml" in result.stderr


def test_a_title_of_two_lines_is_no_command(tmp_path):
    shutil.copytree(ROOT / "stdlib" / "robots" / "industrial6", tmp_path / "arm")
    file = tmp_path / "arm" / "robot.toml"
    text = file.read_text()
    line = next(line for line in text.splitlines() if line.startswith("title"))
    file.write_text(text.replace(line, 'title = "arm\\n#1J+\\nM11=1"'))
    lines = yarc("settings", file).stdout.splitlines()
    assert lines[0] == "; settings of a Turbo PMAC for INDUSTRIAL6: arm?#1J+?M11=1"
    assert not {"#1J+", "M11=1"} & set(lines)


@pytest.fixture
def saved(tmp_path):
    file = tmp_path / "saved.txt"
    file.write_bytes(yarc("settings", "INDUSTRIAL6").stdout_bytes)
    return file


def test_a_saved_text_is_proved(saved):
    for result in (
        yarc("settings", "INDUSTRIAL6", "--check", saved),
        yarc("settings", "INDUSTRIAL6", "--check", "-", content=saved.read_bytes()),
    ):
        assert result.stderr == ""
        assert result.stdout.endswith(
            ": proved for INDUSTRIAL6; axis definitions within 0.000001 deg, PLC 0 within 0.000000 deg\n"
        )


def test_an_edited_text_is_proved_with_warnings(saved):
    saved.write_text(saved.read_text().replace("I120=50 ", "I120=70 "))
    result = yarc("settings", "INDUSTRIAL6", "--check", saved)
    assert (
        f"{saved}:38:1: warning Y1176: the proof holds for I120=70 too, "
        "but `yarc settings INDUSTRIAL6` prints I120=50" in result.stderr
    )
    assert "proved for INDUSTRIAL6" in result.stdout


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            b"CLOSE ALL\n",
            b"CLOSE ALL\r\n",
            ":4:1: error Y1170: line 4 has the character 0x0D (a carriage return)",
        ),
        (b"; motors", b"; m\x85#1J+", ": error Y1170: line 30 has the character 0x85"),
        (b"; motors", "; Schweißen".encode(), ": error Y1170: line 30 has the character 0xC3"),
        (b"; settings", b"\xef\xbb\xbf; settings", ":1:1: error Y1170: line 1 has the character 0xEF"),
        (b"I42=0", b"I42=1", ": error Y1174: I42=1: it must be 0"),
        (b"M8116=0", b"M8116=1", ": error Y1175: line "),
    ],
)
def test_a_wrong_text_is_refused(saved, old, new, expected):
    content = saved.read_bytes()
    assert old in content
    saved.write_bytes(content.replace(old, new))
    result = yarc("settings", "INDUSTRIAL6", "--check", saved, status=1)
    assert expected in result.stderr
    assert result.stdout == ""
    assert result.stderr.count(": error ") == 1


def test_another_robots_text_is_refused(saved):
    result = yarc("settings", "TRACKED_MANIPULATOR", "--check", saved, status=1)
    assert (
        "error Y1171: line 2 says that the settings are for 'INDUSTRIAL6', not for TRACKED_MANIPULATOR"
        in result.stderr
    )


def test_files_that_cannot_be_read(tmp_path):
    for path in (tmp_path / "none.txt", tmp_path):
        result = yarc("settings", "INDUSTRIAL6", "--check", path, status=1)
        assert "error Y0107" in result.stderr
    assert "error Y1170" in yarc("settings", "INDUSTRIAL6", "--check", "-", content=b"", status=1).stderr


# commands that move a robot


SAID = "the settings of INDUSTRIAL6 aren't proved: I115=12.2558: an abort brakes J1"


@pytest.fixture
def program(tmp_path):
    file = tmp_path / "a.yarc"
    file.write_text("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n")
    return file


def test_no_simulated_robot_moves_by_wrong_settings(wrong, program, tmp_path):
    robot = ("--robot", "INDUSTRIAL6")
    assert SAID in yarc("run", program, *robot, "--no-log", status=1).stderr
    assert SAID in yarc("doctor", *robot, status=1).stderr
    assert SAID in yarc("repl", *robot, "--no-log", status=1, content="").stderr
    assert "error Y1174" in yarc("sim", *robot, "--port", "0", status=1).stderr
    for command in (("exec", program), ("follow",)):
        result = yarc(*command, *robot, "--no-log", status=1)
        last = json.loads(result.stdout.splitlines()[-1])
        assert (last["event"], last["status"], last["code"]) == ("ended", 1, "Y1174")
        assert SAID in last["what"]


def test_no_controller_is_asked_by_wrong_settings(wrong, program):
    """With wrong settings, no command contacts the controller.

    Nobody listens at the address here, which isn't even noticed.
    """
    robot = ("--robot", "INDUSTRIAL6", "--to", "tcp://127.0.0.1:1")
    assert SAID in yarc("run", program, *robot, "--no-log", status=1).stderr
    assert SAID in yarc("doctor", *robot, status=1).stderr
    assert SAID in yarc("repl", *robot, "--no-log", status=1, content="").stderr
    for command in (("exec", program), ("follow",)):
        result = yarc(*command, *robot, "--no-log", status=1)
        assert SAID in json.loads(result.stdout.splitlines()[-1])["what"]
