"""A command of several steps is shown with all its steps."""

from click.testing import CliRunner

from yarclang.cli.yarc import main


def test_a_pulse_is_told_with_all_its_steps(tmp_path):
    path = tmp_path / "pulse.yarc"
    path.write_text("ROBOT INDUSTRIAL6\nOUTPUT GLUE M1 OFF\nP0010 PULSE GLUE [0.5] (s)\nP0020 SET GLUE ON\n")
    told = CliRunner().invoke(main, ["inspect", str(path), "P0010"]).output.splitlines()
    assert [one.strip() for one in told if "becomes" in one or "waits for" in one] == [
        "at rest, GLUE (M1) becomes ON",
        "the robot waits for 0.5 s",
        "at rest, GLUE (M1) becomes OFF",
    ]
    told = CliRunner().invoke(main, ["inspect", str(path), "P0020"]).output
    assert told.count("becomes") == 1
