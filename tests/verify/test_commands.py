"""`yarcc --proof` and `yarc verify` as people use them."""

import json

import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc

PROGRAM = "ROBOT INDUSTRIAL6\nP0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "one.yarc").write_text(PROGRAM)
    return tmp_path


def test_a_proof_is_written_beside_the_text_and_followed(folder):
    done = CliRunner().invoke(yarcc, ["one.yarc", "--proof"])
    assert done.exit_code == 0, done.output
    assert json.loads((folder / "one.proof.json").read_text())["robot"]["name"] == "INDUSTRIAL6"
    told = CliRunner().invoke(yarc, ["verify", "one.pmc"])
    assert told.exit_code == 3
    assert "unchecked:\n  torques" in told.output
    assert CliRunner().invoke(yarc, ["verify", "one.pmc", "one.proof.json"]).exit_code == 3


def test_a_changed_text_is_refused(folder):
    CliRunner().invoke(yarcc, ["one.yarc", "--proof"])
    text = (folder / "one.pmc").read_text()
    (folder / "one.pmc").write_text(text.replace("TM50", "TM49"))
    told = CliRunner().invoke(yarc, ["verify", "one.pmc"])
    assert told.exit_code == 1
    assert "one.pmc: refused: the proof is for another text" in told.output


def test_without_the_option_no_proof_is_written(folder):
    assert CliRunner().invoke(yarcc, ["one.yarc"]).exit_code == 0
    assert not (folder / "one.proof.json").exists()
    told = CliRunner().invoke(yarc, ["verify", "one.pmc"])
    assert told.exit_code == 2
    assert "one.proof.json: No such file" in told.output


def test_a_text_without_a_proof_is_not_written_with_one(folder):
    done = CliRunner().invoke(yarcc, ["one.yarc", "--proof", "--target", "prog"])
    assert done.exit_code == 1
    assert "Y1196" in done.output
    assert not (folder / "one.pmc").exists()


def test_a_proof_has_no_place_beside_standard_output(folder):
    done = CliRunner().invoke(yarcc, ["one.yarc", "--proof", "-o", "-"])
    assert done.exit_code == 2
    assert "--proof writes beside the text" in done.output


def test_a_file_without_an_end_is_wrong_usage(folder, monkeypatch):
    monkeypatch.setattr("yarclang.verify.__main__.LARGEST", 1 << 20)
    CliRunner().invoke(yarcc, ["one.yarc", "--proof"])
    told = CliRunner().invoke(yarc, ["verify", "/dev/zero", "one.proof.json"])
    assert (told.exit_code, "larger than 1 MiB" in told.output) == (2, True)
    told = CliRunner().invoke(yarc, ["verify", "one.pmc", "nowhere.json"])
    assert (told.exit_code, "nowhere.json: No such file" in told.output) == (2, True)
