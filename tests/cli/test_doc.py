"""`yarc doc`, which makes a reference from comments."""

import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main
from yarclang.report.module_text import describe_module, module_listing, module_markdown, module_plain
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

TEXT = """\
! Drills holes. Has no pause.
! It needs a drill.
!
! And a hole.
DEFAULT [50%] (mm,deg,s) {B}

! Drills one hole
! where the frame is.
!   {at}  place, z | up
!   t(S)  time
!         of the line
!   OTHER  isn't there
!   CALL DRILLING.ONE {HOLE} 20 1.5
SUB one {at} DEPTH (mm) T (s)
  P0010 MOVEL {TCP} 0 0 $(-DEPTH) 0 0 0 [$T] {AT}
END

SUB BARE {TOOL} COUNT T (s)
END
"""


def described(text):
    return describe_module(parse(SourceFile("some/drilling.yarc", text)).value)


def run(*arguments):
    return CliRunner().invoke(main, ["doc", *arguments])


def test_top_comment_is_taken_in_paragraphs():
    module = described(TEXT)
    assert module.name == "DRILLING"
    assert module.paragraphs == ("Drills holes. Has no pause. It needs a drill.", "And a hole.")
    assert module.title == "Drills holes."


def test_parameters_come_from_the_head_and_meanings_from_the_comment():
    one = described(TEXT).subs[0]
    assert one.head == "ONE {AT} DEPTH (mm) T (s)"
    assert one.purpose == "Drills one hole where the frame is."
    assert [(parameter.name, parameter.meaning) for parameter in one.parameters] == [
        ("{AT}", "place, z | up"),
        ("DEPTH (mm)", ""),
        ("T (s)", "time of the line"),
    ]
    assert one.strangers == ("OTHER",)
    assert one.example == "CALL DRILLING.ONE {HOLE} 20 1.5"


def test_a_sub_without_a_comment_has_its_head_as_example():
    bare = described(TEXT).subs[1]
    assert (bare.purpose, bare.example) == ("", "CALL DRILLING.BARE {TOOL} COUNT T")


@pytest.mark.parametrize(
    "text", ["", "! only a comment", "SUB A\nEND\n", "! does A\nSUB A\nEND\n", "SUB\nEND\n"]
)
def test_a_module_may_say_little(text):
    module = described(text)
    assert module_plain(module).startswith("DRILLING")
    assert module_markdown(module).startswith("# DRILLING")
    assert module_listing([module])


def test_a_comment_on_the_first_sub_is_not_the_modules():
    module = described("! does A\nSUB A\nEND\n")
    assert module.paragraphs == ()
    assert module.subs[0].purpose == "does A"
    assert "no comment says what it is for" in module_listing([module])


def test_text_and_markdown():
    module = described(TEXT)
    text = module_plain(module)
    assert "DRILLING.ONE {AT} DEPTH (mm) T (s)\n  Drills one hole where the frame is.\n    {AT}" in text
    assert "  for example: CALL DRILLING.ONE {HOLE} 20 1.5" in text
    markdown = module_markdown(module)
    assert "## DRILLING.ONE" in markdown
    assert "| `{AT}` | place, z \\| up |" in markdown
    assert "```\nCALL DRILLING.ONE {HOLE} 20 1.5\n```" in markdown


def test_doc_lists_the_modules():
    result = run()
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert [line.split()[0] for line in lines] == [
        "APPROACH",
        "GOHOME",
        "PALLET",
        "PATTERN",
        "PICKPLACE",
        "WARMUP",
        "WEAVE",
    ]
    assert all(len(line) < 120 for line in lines)


def test_doc_prints_a_reference_in_any_case():
    result = run("pickplace")
    assert result.exit_code == 0
    assert result.stdout.startswith("PICKPLACE\n")
    assert "for example: CALL PICKPLACE.PICK {GRIPPER} {BOX} 100 GRIP 1.5" in result.stdout
    assert max(map(len, result.stdout.splitlines())) <= 96


def test_doc_writes_markdown():
    result = run("PALLET", "--format", "markdown")
    assert result.exit_code == 0
    assert result.stdout.startswith("# PALLET\n")


def test_doc_of_a_module_that_is_not_there():
    result = run("PALET")
    assert result.exit_code == 1
    assert result.stdout == ""
    assert "no module is named PALET" in result.stderr
    assert "did you mean PALLET?" in result.stderr


def test_doc_finds_a_module_beside_the_program(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "drilling.yarc").write_text(TEXT)
    assert "DRILLING.ONE" in run("drilling").stdout


def test_doc_of_a_module_with_errors_says_them(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "broken.yarc").write_text("! Broken.\nSUB A\nEND\n??\n")
    result = run("broken")
    assert result.exit_code == 1
    assert "Y01" in result.stderr


def test_functions_are_told_with_their_parameters():
    module = described(
        TEXT
        + (
            "\n"
            "! What a hole takes,\n"
            "! in seconds.\n"
            "FUNC lasting(N, DEPTH (MM)) = N * DEPTH / 10\n"
            "FUNC BARE2(A) = A\n"
        )
    )
    assert [one.head for one in module.functions] == ["LASTING(N, DEPTH (mm))", "BARE2(A)"]
    plain, marked = module_plain(module), module_markdown(module)
    assert "DRILLING.LASTING(N, DEPTH (mm))\n  What a hole takes, in seconds.\n" in plain
    assert "## DRILLING.LASTING(N, DEPTH (mm))\n\nWhat a hole takes, in seconds." in marked
    assert plain.rstrip().endswith("DRILLING.BARE2(A)")
