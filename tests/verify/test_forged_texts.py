"""Changed texts are refused, even if the proof has the changed text's hash."""

import re

import pytest

from tests.verify.proof_forging import BLENDED, MOTIONS, WAYS, made, refused_text


def line_of(text, form):
    """Return the index of the first line that matches a form."""
    return next(k for k, line in enumerate(text.split("\n")) if re.fullmatch(form, line))


def with_line(text, number, *lines):
    """Return a text in which one line is replaced by others."""
    kept = text.split("\n")
    kept[number : number + 1] = lines
    return "\n".join(kept)


def put_before(text, form, *lines):
    number = line_of(text, form)
    return with_line(text, number, *lines, text.split("\n")[number])


def replaced(text, form, by):
    made_, count = re.subn(form, by, text, count=1, flags=re.MULTILINE)
    assert count == 1, form
    return made_


FORGERIES = {
    "an I-variable": lambda text: put_before(text, "P8100=1", "I5195=1"),
    "a motor variable": lambda text: put_before(text, "M20=1", "M161=1"),
    "another output": lambda text: replaced(text, "^M20=1$", "M21=1"),
    "another value": lambda text: replaced(text, "^M20=1$", "M20=0"),
    "no output": lambda text: replaced(text, "^M20=1\n", ""),
    "an output in motion": lambda text: put_before(text, r"CLOSE", "M20==1"),
    "a shorter dwell": lambda text: replaced(text, "^DWELL500$", "DWELL50"),
    "no dwell": lambda text: replaced(text, "^DWELL500\n", ""),
    "no rest before an output": lambda text: replaced(text, "^DWELL0\nM20=1$", "M20=1"),
    "no stop": lambda text: replaced(text, "^STOP$", "DWELL0"),
    "another segment time": lambda text: replaced(text, r"^TM[0-9.]+$", "TM40"),
    "a segment time that isn't kept": lambda text: replaced(text, r"^TM[0-9.]+$", "TM40.00001"),
    "a segment time beyond the controller": lambda text: replaced(text, r"^TM[0-9.]+$", "TM4096"),
    "a guard that isn't armed": lambda text: replaced(text, "^P8100=1\n", ""),
    "a guard that is off early": lambda text: replaced(text, "^P8100=1$", "P8100=P8100&2"),
    "lower marks": lambda text: replaced(text, "^I16=[0-9]+$", "I16=1"),
    "marks that never fill": lambda text: replaced(text, "^I17=[0-9]+$", "I17=9999"),
    "a small buffer": lambda text: replaced(text, "^DEFINE ROT [0-9]+$", "DEFINE ROT 48"),
    "another system": lambda text: replaced(text, "^&1$", "&2"),
    "other motors": lambda text: replaced(text, "^#1J/", "#7J/"),
    "another way to run": lambda text: replaced(text, "^CLEAR$", "CLEAR\nR"),
    "a line after the end": lambda text: text + "R\n",
    "no end": lambda text: text[:-1],
    "a carriage return": lambda text: text.replace("CLOSE ALL\n", "CLOSE ALL\r\n"),
    "a form feed": lambda text: text.replace("SPLINE1\n", "SPLINE1\f\n", 1),
    "a comment in the program": lambda text: put_before(text, "P8100=1", "; note"),
    "an empty line": lambda text: put_before(text, "P8100=1", ""),
    "a line too long": lambda text: put_before(text, "P8100=1", "X" + "1" * 300),
    "LINEAR": lambda text: text.replace("\nSPLINE1\n", "\nLINEAR\n", 1),
    "another robot": lambda text: replaced(text, "^; robot [A-Z0-9]+", "; robot OTHER"),
    "another start in the header": lambda text: replaced(text, "^; start X0", "; start X1"),
    "another duration": lambda text: replaced(text, "^; duration [0-9]+", "; duration 1"),
    "another name": lambda text: replaced(text, "^; command 1 P0020", "; command 1 P0021"),
    "a jerk without limit": lambda text: replaced(text, r"^(; command 1 .*)$", r"\1 any-jerk"),
    "a blend that isn't there": lambda text: replaced(text, r"^(; command 1 .*)$", r"\1 blend 4"),
    "safe values": lambda text: text.replace("P8104=2)\nM20=0\n", "P8104=2)\nM20=1\n"),
    "no safe values after the watchdog's hold": lambda text: text.replace(" OR P8104=2)", ")"),
}


@pytest.mark.parametrize("name", FORGERIES)
def test_a_forged_text_is_refused(name):
    text, _ = made(MOTIONS)
    forged = FORGERIES[name](text)
    assert forged != text
    assert refused_text(MOTIONS, forged)


def test_every_changed_number_of_a_move_is_refused():
    """A move that is off by 0.05 deg leaves its path by more than 0.002 deg, or breaks a limit."""
    text, _ = made(MOTIONS)
    lines = text.split("\n")
    moves = [k for k, line in enumerate(lines) if re.match(r"X-?[0-9].*C-?[0-9]", line)]
    assert len(moves) > 200
    for k in moves[3::67]:
        for axis in "XYZABC":
            moved = re.sub(
                rf"({axis})(-?[0-9.]+)", lambda found: f"{found[1]}{float(found[2]) + 0.05:.6f}", lines[k]
            )
            assert refused_text(MOTIONS, with_line(text, k, moved)), (k, axis)


def test_every_missing_line_is_refused():
    text, _ = made(BLENDED)
    lines = text.split("\n")[:-1]
    optional = [k for k, line in enumerate(lines) if line.startswith(("; longest", "; ways round"))]
    blended = 0
    for k in range(len(lines)):
        if k in optional or (blended := blended + 1) % 7:
            continue
        forged = "\n".join(lines[:k] + lines[k + 1 :]) + "\n"
        assert refused_text(BLENDED, forged), lines[k]


def test_an_output_belongs_in_the_middle_of_its_blend():
    text, _ = made(BLENDED)
    number = line_of(text, "M20==1")
    lines = text.split("\n")
    for way in (-12, 12):
        moved = lines[:number] + lines[number + 1 :]
        moved.insert(number + way, "M20==1")
        assert refused_text(BLENDED, "\n".join(moved))


def test_ways_meet_at_one_place():
    text, _ = made(WAYS)
    stands = [k for k, line in enumerate(text.split("\n")) if line == "RAPID"]
    assert len(stands) > 2
    for k in stands:
        line = text.split("\n")[k + 2]
        moved = re.sub(r"X(-?[0-9.]+)", lambda found: f"X{float(found[1]) + 0.5:g}", line)
        assert refused_text(WAYS, with_line(text, k + 2, moved))
