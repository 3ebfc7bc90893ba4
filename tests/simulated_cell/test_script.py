"""Tests of reading scripts of inputs, and of the findings about mistakes in them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import planned

from yarclang.pmac.variables import signal_variable
from yarclang.simulated_cell.script import Change, Known, known_in, load_script, read_script, read_setting
from yarclang.source import SourceFile

KNOWN = Known(
    {"PART_READY": "M11"},
    {"GRIP": "M1"},
    frozenset({"P0010(#0)", "P0020(#0)>P0010"}),
    signal=lambda text: signal_variable(text, ("P20",)),
)


def read(text, known=KNOWN):
    return read_script(SourceFile("inputs.toml", text), known)


def entry(**keys):
    lines = {"input": '"PART_READY"', "to": '"ON"', "at": "2.0", **keys}
    return "[[inputs]]\n" + "".join(f"{key} = {value}\n" for key, value in lines.items() if value is not None)


GROUP = Known(
    {"JOB.0": "M70", "JOB.1": "M71"},
    {},
    frozenset(),
    signal=lambda text: signal_variable(text, ()),
    groups={"JOB": ("M70", "M71")},
)


def test_a_group_changes_bit_by_bit_at_one_instant():
    made = read(entry(input='"JOB"', to="2"), GROUP)
    assert made.diagnostics == ()
    assert made.value == (Change("M70", 0.0, at=2.0), Change("M71", 1.0, at=2.0))
    assert read_setting("JOB=1", GROUP).value == (Change("M70", 1.0, at=0.0), Change("M71", 0.0, at=0.0))
    assert read(entry(input='"JOB.1"', to="1"), GROUP).value == (Change("M71", 1.0, at=2.0),)


@pytest.mark.parametrize(
    ("keys", "what"),
    [
        ({"to": "4"}, "JOB is 4, but a group of 2 bits is an integer from 0 to 3"),
        ({"to": "0.5"}, "JOB is 0.5"),
        ({"to": "-1"}, "JOB is -1"),
        ({"to": "1", "toggle": "[1, 1]"}, "only a single input toggles"),
    ],
)
def test_a_group_is_an_integer_of_its_bits(keys, what):
    found = read(entry(input='"JOB"', **keys), GROUP).diagnostics
    assert [one.code for one in found] == ["Y1618"]
    assert what in found[0].message
    if "toggle" not in keys:
        assert read_setting(f"JOB={keys['to']}", GROUP).diagnostics[0].code == "Y1618"


def test_a_script_is_read():
    made = read(
        entry(toggle="[1.0, 2]", stuck="true")
        + entry(input='"m012"', to="2.5", at=None, place='"P0020"', delay="0.5")
        + entry(to='"off"', at=None, output='"grip=ON"')
    )
    assert made.diagnostics == ()
    assert made.value == (
        Change("M11", 1.0, at=2.0, toggle=(1.0, 2.0), stuck=True),
        Change("M12", 2.5, place="P0020", delay=0.5),
        Change("M11", 0.0, output=("M1", 1.0)),
    )


def test_an_empty_script_does_nothing():
    assert read("# nothing\n").value == ()


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("[[inputs", "Y1303", "not TOML"),
        ("inputs = 3\n", "Y1306", "inputs"),
        ("[[input]]\n", "Y1305", "inputs"),
        ("[[inputs]]\nto = 1\nat = 0\n", "Y1304", "input"),
        (entry(to=None), "Y1304", "to"),
        (entry(to='"MAYBE"'), "Y1306", '"ON", "OFF" or a number'),
        (entry(to="true"), "Y1306", '"ON", "OFF" or a number'),
        (entry(to="nan"), "Y1307", "finite"),
        (entry(to="1e10"), "Y1308", "at most"),
        (entry(at="-1"), "Y1308", "at least 0"),
        (entry(at="inf"), "Y1307", "finite"),
        (entry(delay="-0.5"), "Y1308", "at least 0"),
        (entry(delay="nan"), "Y1307", "finite"),
        (entry(at='"soon"'), "Y1306", "a number"),
        (entry(delya="1"), "Y1305", "Did you mean delay?"),
        (entry(toggle="[0, 0]"), "Y1308", "at least 0.001"),
        (entry(toggle="[1]"), "Y1618", "1 times, not 2"),
        (entry(toggle="[1, 1, 1]"), "Y1618", "3 times, not 2"),
        (entry(stuck='"yes"'), "Y1306", "true or false"),
        (entry(stuck="true") + entry(stuck="true"), "Y1618", "stuck already"),
        (entry(at=None), "Y1618", "none of at, place and output"),
        (entry(place='"P0010"'), "Y1618", "at and place"),
        (entry(input='"PART_REDY"'), "Y1617", "Did you mean PART_READY?"),
        (entry(input='"GRIP"'), "Y1618", "is an output"),
        (entry(input='"M1"'), "Y1618", "is the output GRIP"),
        (entry(input='"P20"'), "Y0413", "used by yarclang itself"),
        (entry(input='"M8116"'), "Y0413", "used by yarclang itself"),
        (entry(input='"M9999"'), "Y1617", "No input"),
        (entry(at=None, place='"P0030"'), "Y1617", "no command P0030"),
        (entry(at=None, place='"P0010(#7)"'), "Y1617", "Did you mean P0010?"),
        (entry(at=None, output='"GRIP"'), "Y1308", "CLAMP=ON"),
        (entry(at=None, output='"GRIPP=ON"'), "Y1617", "Did you mean GRIP?"),
        (entry(at=None, output='"GRIP=MAYBE"'), "Y1308", "CLAMP=ON"),
        (entry(input='"' + "A" * 5000 + '"'), "Y1617", "No input"),
        ("x = " + "[" * 5000, "Y1303", ""),
    ],
)
def test_a_mistake_is_said_at_its_line(text, code, words):
    made = read(text)
    assert made.value is None
    told = [(one.code, f"{one.message} {one.help}") for one in made.diagnostics]
    assert any(of == code and words in what for of, what in told), told
    assert all(one.span is not None for one in made.diagnostics)


def test_a_huge_script_is_refused_at_once():
    (found,) = read(entry() * 200_000).diagnostics
    assert found.code == "Y1302"


def test_a_file_that_is_not_there_is_said(tmp_path):
    assert [one.code for one in load_script(tmp_path / "no.toml", KNOWN).diagnostics] == ["Y1302"]
    (tmp_path / "bytes.toml").write_bytes(b"\xff\x00\xfe")
    assert [one.code for one in load_script(tmp_path / "bytes.toml", KNOWN).diagnostics] == ["Y1302"]


def test_a_controller_alone_knows_no_place():
    known = Known({}, {}, has_places=False)
    (found,) = read(entry(input='"M11"', at=None, place='"P0010"'), known).diagnostics
    assert (found.code, "which a controller doesn't know" in found.message) == ("Y1617", True)


def test_without_a_program_places_are_taken_as_they_are():
    assert read(entry(input='"M11"', at=None, place='"P0010"'), Known({}, {})).value is not None


@given(st.text(max_size=200))
def test_any_text_is_read_or_refused(text):
    made = read(text)
    assert (made.value is None) == bool(made.diagnostics)


@given(
    st.dictionaries(
        st.sampled_from(["input", "to", "at", "place", "output", "delay", "toggle", "stuck"]),
        st.sampled_from(
            [
                '"PART_READY"',
                '"ON"',
                "1",
                "-1",
                "nan",
                "1e400",
                "[]",
                "[1, 2]",
                "true",
                '""',
                "{}",
                '"P0010"',
                '"="',
                '">"',
                '"GRIP=1"',
                "9" * 400,
            ]
        ),
    )
)
def test_any_entry_is_read_or_refused(keys):
    made = read("[[inputs]]\n" + "".join(f"{key} = {value}\n" for key, value in keys.items()))
    assert (made.value is None) == bool(made.diagnostics)


@pytest.mark.parametrize("text", ["PART_READY", "PART_READY=", "=1", "PART_READY=nan", "PART_READY=x", ""])
def test_a_setting_of_another_form_is_wrong(text):
    with pytest.raises(ValueError, match="isn't INPUT=ON"):
        read_setting(text, KNOWN)


def test_a_setting_is_read():
    assert read_setting("part_ready=on", KNOWN).value == (Change("M11", 1.0, at=0.0),)
    assert read_setting("M12=2.5", KNOWN).value == (Change("M12", 2.5, at=0.0),)
    assert read_setting("GRIP=1", KNOWN).diagnostics[0].code == "Y1618"


def test_a_command_whose_beginning_a_run_does_not_report_is_said():
    text = (
        "INPUT DOOR M11\nOUTPUT LAMP M1 OFF\nP0010 MOVEJ 5 0 0 0 0 0 [2] (deg,s)\nP0020 SET LAMP ON\n"
        'P0030 WAIT [1] (s)\nP0040 WAIT DOOR ON [5] (s) ELSE\n  P0050 HOLD "shut the door"\nEND\n'
    )
    known = known_in(planned(text)[0].program, None)
    for place in ("P0010", "P0040", "P0050"):
        assert read(entry(input='"M11"', at=None, place=f'"{place}"'), known).diagnostics == ()
    for place in ("P0020", "P0030"):
        (found,) = read(entry(input='"M11"', at=None, place=f'"{place}"'), known).diagnostics
        assert found.code == "Y1618"
        assert place in found.message
