"""Values from outside as people use them.

They come through `yarc serve --values`, from a camera over TCP or on the run's socket, or are simulated.
"""

import re
import signal
import stat

import pytest

from yarclang.client import Gone, Refused, Robot

PROGRAM = """\
ROBOT INDUSTRIAL6
REGISTER SEEN 0..1 OUTSIDE
REGISTER X -20000..20000 OUTSIDE
P0010 MOVEJ 1 0 0 0 0 0 [0.5] (deg,s)
P0020 WAIT SEEN = 1 AND X > -20000 [20] (s) ELSE
  P0030 SAY "nothing"
END
P0040 SAY "X is {X}"
P0050 MOVEJ 0 0 0 0 0 0 [0.5] (deg,s)
"""
CELL = """\
units = "mm,deg"
[frames]
TRAY = { parent = "B", xyz = [1000, 200, 300] }
[[parts]]
name = "BOX"
shape = "box"
frame = "TRAY"
xyz = [12.34, 0, 30]
size = [40, 40, 40]
"""
CAMERA = '[[cameras]]\npart = "BOX"\nframe = "TRAY"\nx = "X"\nfound = "SEEN"\n'


def test_a_camera_over_tcp_gives_values_to_a_served_robot(workshop):
    process = workshop.start(
        "serve", "--robot", "INDUSTRIAL6", "--no-log", "--values", "0", "--values-token", "token"
    )
    process.wait_for("is served: ")
    process.wait_for("with the token in")
    place = re.search(r"values are accepted at (127\.0\.0\.1:\d+), with the token in token", process.text)[1]
    file = workshop.folder / "token"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    token = file.read_text().strip()
    workshop.write("c.yarc", PROGRAM)
    ran = workshop.start("run", "c.yarc")
    with Robot(f"tcp://{place}", name="camera", token=token) as camera:
        wanted = camera.wanted(30.0)
        assert wanted["place"] == "P0020 WAIT"
        with pytest.raises(Refused, match="X can't be 99999"):
            camera.fill({"SEEN": 1, "X": 99999}, wanted["number"])
        assert camera.fill({"SEEN": 1, "X": 777}, wanted["number"])["values"]["X"] == 777
        text = ran.end(0)
        assert "camera gives SEEN = 1, X = 777" in text
        assert "values of camera are refused: X can't be 99999" in text
        assert "X is 777" in text
        with pytest.raises(Refused, match="no WAIT or HOLD"):
            camera.fill({"SEEN": 1, "X": 1})
    with pytest.raises((Refused, Gone)):
        Robot(f"tcp://{place}", token="0" * 43)
    process.signal(signal.SIGTERM)
    assert "Traceback" not in process.end(0)
    assert not file.exists()


def test_a_script_on_the_socket_of_a_run_does_the_same(workshop, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", workshop.environment["XDG_RUNTIME_DIR"])
    workshop.write("c.yarc", PROGRAM)
    ran = workshop.start("run", "c.yarc", "--log", "run.mcap")
    ran.wait_for("takes values from outside: ")
    with Robot(name="script") as script:
        script.fill({"SEEN": 1, "X": -5}, script.wanted(20.0)["number"])
    assert "X is -5" in ran.end(0)
    told = workshop.here("replay", "run.mcap", "--speed", "max")
    assert "script gives SEEN = 1, X = -5" in told
    assert "X is -5" in told


def test_a_simulated_camera_answers(workshop):
    workshop.write("cell.toml", CELL)
    workshop.write("yarc.toml", 'robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    workshop.write("c.yarc", PROGRAM)
    workshop.write("s.toml", CAMERA + "delay = 0.2\n")
    text = workshop.yarc("run", "c.yarc", "--inputs", "s.toml", "--no-log")
    assert "camera gives X = 1234, SEEN = 1" in text or "camera gives SEEN = 1, X = 1234" in text
    assert "X is 1234" in text
    workshop.write("s.toml", CAMERA.replace("BOX", "BIX"))
    text = workshop.here("run", "c.yarc", "--inputs", "s.toml", "--no-log", status=1)
    assert "No part of the cell is named BIX" in text


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--values", "5050"), "--values and --values-token go together"),
        (("--values-token", "x"), "--values and --values-token go together"),
        (("--values", "99999", "--values-token", "x"), "isn't [HOST:]PORT"),
        (("--values", "here:", "--values-token", "x"), "isn't [HOST:]PORT"),
    ],
)
def test_wrong_usage(workshop, words, said):
    assert said in workshop.here("serve", "--robot", "INDUSTRIAL6", *words, status=2)


def test_an_address_that_is_nobodys(workshop):
    text = workshop.yarc(
        "serve",
        "--robot",
        "INDUSTRIAL6",
        "--no-log",
        "--values",
        "203.0.113.1:0",
        "--values-token",
        "x",
        status=1,
    )
    assert "203.0.113.1:0 can't be listened on" in text
    assert "Traceback" not in text
