"""`yarc jobs` and `yarc run FOLDER --job N`, with the numbered programs of a project."""

import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main

HEAD = 'robot = "INDUSTRIAL6"\n\n[jobs]\n'
THERE = "P0010 MOVEJ {0} 0 0 0 20 0 [MIN] (deg)\n"
BACK = "P0020 MOVEJ HOME [MIN]\n"


@pytest.fixture
def project(tmp_path, monkeypatch):
    (tmp_path / "yarc.toml").write_text(f'{HEAD}1 = "left.yarc"\n2 = "right.yarc"\n')
    (tmp_path / "left.yarc").write_text(THERE.format(20) + BACK)
    (tmp_path / "right.yarc").write_text(THERE.format(-20) + BACK)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def yarc(*arguments):
    done = CliRunner().invoke(main, arguments)
    assert "Traceback" not in done.output
    return done


@pytest.mark.parametrize("where", [(), (".",), ("yarc.toml",)])
def test_jobs_are_proved_and_listed_by_their_numbers(project, where):
    done = yarc("jobs", *where)
    assert done.exit_code == 0
    assert done.output.splitlines() == [
        "1  left.yarc   1.606 s, certified",
        "2  right.yarc  1.606 s, certified",
    ]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (THERE.format(-20), "job 2 ends with J1 at -20 deg, but job 1 begins at 0 deg"),
        (
            "JOINTS A 10 0 0 0 0 0 (deg)\nSTART A\n" + THERE.format(20) + "P0020 MOVEJ A [MIN]\n",
            "job 2 begins with J1 at 10 deg, but job 1 begins at 0 deg",
        ),
        (
            "ROBOT TRACKED_MANIPULATOR\nP0010 MOVEJ HOME [1] (s)\n",
            "job 2 is for TRACKED_MANIPULATOR, job 1 for INDUSTRIAL6",
        ),
        ("P0010 MOVEJ 900 0 0 0 0 0 [MIN] (deg)\n", "Y0502"),
        ("P0010 MOVEK\n", "Y0202"),
    ],
)
def test_a_job_that_no_other_could_follow_is_an_error(project, text, said):
    (project / "right.yarc").write_text(text)
    done = yarc("jobs")
    assert done.exit_code == 1
    assert said in done.output
    assert "2  right.yarc  not certified" in done.output


def test_a_job_whose_ways_end_apart_is_an_error(project):
    (project / "right.yarc").write_text(
        "INPUT A M11\nWHEN A ON\n" + THERE.format(20) + "P0015 STOP\nEND\n" + BACK
    )
    done = yarc("jobs")
    assert done.exit_code == 1
    assert "job 2 ends" in done.output


def test_a_file_that_is_not_there(project):
    (project / "right.yarc").unlink()
    done = yarc("jobs")
    assert done.exit_code == 1
    assert "Y0107" in done.output


@pytest.mark.parametrize(
    ("jobs", "said"),
    [
        ('-1 = "left.yarc"\n', "'-1' isn't the number of a job"),
        ('70000 = "left.yarc"\n', "'70000' isn't the number of a job"),
        ('1.5 = "left.yarc"\n', "job 1 isn't the path of a program"),
        ('"1.5" = "left.yarc"\n', "'1.5' isn't the number of a job"),
        ('left = "left.yarc"\n', "'left' isn't the number of a job"),
        ('"١" = "left.yarc"\n', "isn't the number of a job"),
        ('1 = "left.yarc"\n01 = "right.yarc"\n', "job 1 is given twice"),
        ("1 = 5\n", "job 1 isn't the path of a program"),
        ('1 = "left.txt"\n', "job 1 isn't the path of a program"),
        ('1 = ["left.yarc"]\n', "job 1 isn't the path of a program"),
    ],
)
def test_tables_that_are_none(project, jobs, said):
    (project / "yarc.toml").write_text(HEAD + jobs)
    for command in (("jobs",), ("check", "left.yarc"), ("run", ".", "--job", "1")):
        done = yarc(*command)
        assert done.exit_code == 1
        assert "Y1393" in done.output
        assert said in done.output


def test_jobs_that_are_no_table(project):
    (project / "yarc.toml").write_text('robot = "INDUSTRIAL6"\njobs = 5\n')
    assert "jobs is a table" in yarc("jobs").output


def test_a_project_without_jobs_is_wrong_usage(project, tmp_path):
    (project / "yarc.toml").write_text('robot = "INDUSTRIAL6"\n')
    assert yarc("jobs").exit_code == 2
    (project / "yarc.toml").unlink()
    done = yarc("jobs")
    assert done.exit_code == 2
    assert "no yarc.toml is in" in done.output


def test_a_job_is_run_by_its_number(project):
    done = yarc("run", ".", "--job", "2", "--rate", "50", "--no-log")
    assert done.exit_code == 0
    assert "right.yarc: done" in done.output


def test_a_number_that_no_job_has(project):
    done = yarc("run", ".", "--job", "7")
    assert done.exit_code == 2
    assert "there is no job 7: " in done.output
    assert "has 1, 2" in done.output
