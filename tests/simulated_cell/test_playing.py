"""Tests of a simulated cell on a simulated controller and on the command line."""

import pytest
from click.testing import CliRunner
from conftest import EXAMPLES
from simulator.machines import robot_machine

from yarclang.cli.yarc import main
from yarclang.simulated_cell.playing import SimulatedCell
from yarclang.simulated_cell.script import Change
from yarclang.simulator.beside import Beside


def value(machine, variable):
    return float(machine.command(variable, 7).items[0])


@pytest.mark.parametrize("steps", [[3.0], [0.01] * 300, [0.007] * 428 + [0.004]])
def test_inputs_change_at_their_exact_times_however_time_passes(steps):
    _, machine = robot_machine("INDUSTRIAL6", False)
    heard = []
    machine.variables.watch("M", 11, lambda now: heard.append((round(machine.now - begin, 9), now)))
    machine.variables.watch("M", 12, lambda now: heard.append((round(machine.now - begin, 9), now)))
    cell = SimulatedCell(
        [
            Change("M11", 1.0, at=0.1234, toggle=(0.5, 1.0)),
            Change("M12", 1.0, output=("M5", 1.0), delay=0.0303),
        ]
    )
    begin = machine.now
    cell.attach(Beside(machine))
    machine.command("M5->*", 7)
    machine.command("M5=1", 7)
    for step in steps:
        machine.advance(step)
    assert heard == [(0.0303, 1.0), (0.1234, 1.0), (0.6234, 0.0), (1.6234, 1.0), (2.1234, 0.0)]


def test_what_is_said_in_another_thread_holds_from_the_next_instant_on():
    _, machine = robot_machine("INDUSTRIAL6", False)
    cell = SimulatedCell([Change("M11", 1.0, place="P0010", delay=0.5)], waits=True)
    cell.attach(Beside(machine))
    machine.advance(5.0)
    cell.begin()
    cell.reached("P0010")
    cell.set("M12", 3.0)
    machine.advance(0.4)
    assert (value(machine, "M11"), value(machine, "M12")) == (0.0, 3.0)
    machine.advance(0.2)
    assert value(machine, "M11") == 1.0


def test_settings_hold_from_the_start():
    _, machine = robot_machine("INDUSTRIAL6", False)
    SimulatedCell(settings=[Change("M11", 1.0, at=0.0), Change("P40", 2.0, at=0.0)], waits=True).attach(
        Beside(machine)
    )
    assert (value(machine, "M11"), value(machine, "P40")) == (1.0, 2.0)


def yarc(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


WELD = EXAMPLES / "10_weld_seam.yarc"


@pytest.mark.parametrize(
    ("words", "status", "told"),
    [
        (("--set", "CLAMPD=1"), 1, "Did you mean CLAMPED?"),
        (("--set", "GAS=1"), 1, "is an output"),
        (("--set", "CLAMPED"), 2, "isn't INPUT=ON"),
        (("--set", "CLAMPED=1", "--to", "tcp://127.0.0.1:9"), 2, "simulated robot"),
        (("--inputs", "none.toml", "--to", "tcp://127.0.0.1:9"), 2, "simulated robot"),
        (("--inputs", "none.toml"), 1, "Y1302"),
    ],
)
def test_a_wrong_option_moves_nothing(words, status, told):
    done = yarc("run", WELD, "--no-log", *words)
    assert (done.exit_code, told in done.output) == (status, True), done.output


def test_a_script_with_a_mistake_moves_nothing(tmp_path):
    script = tmp_path / "inputs.toml"
    script.write_text('[[inputs]]\ninput = "CLAMPED"\nto = "ON"\nplace = "P9999"\n')
    done = yarc("run", WELD, "--no-log", "--inputs", script)
    assert done.exit_code == 1
    assert "no command P9999" in done.output
    script.write_text('[[inputs]]\ninput = "M11"\nto = "ON"\nplace = "P0010"\n')
    done = yarc("sim", "--port", "0", "--inputs", script)
    assert done.exit_code == 1
    assert "which a controller doesn't know" in done.output


def test_a_waiting_program_runs_to_its_end_with_a_setting(tmp_path):
    program = tmp_path / "waits.yarc"
    program.write_text(
        "ROBOT INDUSTRIAL6\nINPUT DOOR M11\nSTART HOME\n"
        "P0010 WAIT DOOR ON [2] (s)\nP0020 MOVEJ 5 0 0 0 0 0 [0.5] (deg,s)\n"
    )
    done = yarc("run", program, "--no-log", "--rate", "5", "--set", "DOOR=ON")
    assert done.exit_code == 0, done.output
    script = tmp_path / "inputs.toml"
    script.write_text('[[inputs]]\ninput = "DOOR"\nto = "ON"\nplace = "P0010"\ndelay = 0.3\n')
    done = yarc("run", program, "--no-log", "--rate", "5", "--inputs", script)
    assert done.exit_code == 0, done.output
    script.write_text('[[inputs]]\ninput = "DOOR"\nto = "ON"\nat = 50\n')
    done = yarc("run", program, "--no-log", "--rate", "5", "--inputs", script)
    assert done.exit_code == 1
    assert "Y1604" in done.output
