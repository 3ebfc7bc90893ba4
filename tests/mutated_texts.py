"""Mistakes that people, editors and software make in texts of programs, and laws that hold for any text.

A seed determines a text: one of the existing programs with some random damage.
"""

import random
import re
import signal
import time
from contextlib import contextmanager
from functools import cache
from pathlib import Path

from tests.assist.test_typing import ask_all, ask_here
from tests.assist.texts import LIBRARY
from yarclang.assist.sketch import sketch_of
from yarclang.assist.view import View
from yarclang.diagnostics import Diagnostic
from yarclang.findings import YARCLANG
from yarclang.highlight.lexer import YarcLexer
from yarclang.highlight.words import words
from yarclang.pipeline.checking import Checked, check_further, check_text
from yarclang.pipeline.fixing import edited
from yarclang.pipeline.incremental import Analyst
from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile, Span
from yarclang.syntax import parse as parsing
from yarclang.syntax.form import usual_form
from yarclang.syntax.lines import code_of

ROOT = Path(__file__).resolve().parents[1]
LONGEST = 10_000
"""Most characters of a text, or a few more."""

LONGEST_MESSAGE = 1_000

PATIENCE, ALL_PATIENCE = 10.0, 60.0
"""Limits of processor time for a check, and for all requests about a text [s]."""

MANY_STEPS = 20_000
"""From this number of steps on, the time depends on the loops rather than on the text."""

PLANNED = 25
"""Of this many texts, one is planned as well."""


_TOKEN = re.compile(
    r"\{[^}\n]*\}|\[[^\]\n]*\]|\([^)\n]*\)|\"[^\"\n]*\"|![^\n]*|[^\s{}\[\]()\"]+|[\[\](){}]|\n"
)
_BLOCK = re.compile(r"```yarc[^\n]*\n(.*?)```", re.DOTALL)

FOREIGN = (
    "\u00a0\u2003\u3000\u2028\u2029\u0085\v\f\x1c\x1d\x1e\x1f\u200b\u200d\ufeff\u00ad\u200e\u200f\u202e\u2066\0\x7f\x1b\t\r"
    "\u2212\u2013\u2010\u2011\u2014\uff0d\uff15\uff3b\uff3d\u0663\u201c\u201d\u2018\u00b2\u00bd\u00d7\u2264\u03c0\u00b0\u0301\ufe0f"
    "äßÅМ🤖\ud800\udc80\udfff\U000e0041\U0010ffff"
)
SIGNS = "!\"#$%&'()*+,-./:;<=>?@[\\]^_`{|}~ 0123456789PMEeVx\n"
PIECES = (
    "!", '"', "{", "}", "[", "]", "(", ")", "$(", ";", ",", ";\n", "\n", "\r\n", "\r", " ! ", "{!", '{"',
        "P0010 ", "P1", "END\n", "ELSE\n",
    "REPEAT 3\n", "REPEAT I 2\n", "SUB X {A} B (mm)\n", "IF 1 > 0\n", "WHEN DOOR ON\n", "LET A = ",
        "FRAME {F} ", "JOINTS J ", "DEFAULT ",
    "USE PALLET\n", "CELL \"cell.toml\"\n", "ROBOT INDUSTRIAL6\n", "STOP\n", "CALL X {TCP} 1 (mm)\n",
        " BLEND 5", " ACC 30%", " NEAR HOME", " TOL 0.05",
    "[MIN]", "[V 250]", "[50%]", "(mm,deg,s)", "(deg)", "{TCP}", "{B}", "$A", "$(A*2)", "$", "%", "**",
        "1e999", "-1e308", "nan", "inf",
    "0x10", "1_000", "1,5", "30-5", "9" * 400, "1." + "0" * 300, "P" + "1" * 30, "A" * 300, "(" * 120,
        ")" * 120, "-" * 120, "[" * 50,
    "! yarc: ignore[Y0603]", "! yarc: ignore[", "; yarcc ", "CLOSE\n", "\\", "#", "//", "_RPY", "_AVOID",
        "_SPLINE", "_TOPP", "HOME",
)  # fmt: skip


FILES = (
    "examples/*.yarc",
    "stdlib/modules/*.yarc",
    "tests/golden/*/*.yarc",
    "tests/rejected/*.yarc",
    "tests/syntax/*.yarc",
)
"""Patterns of files that contain whole programs."""


@cache
def programs() -> tuple[tuple[Path, str], ...]:
    """Return the existing programs, each with its folder."""
    found = [
        (path.parent, path.read_text(encoding="utf-8"))
        for pattern in FILES
        for path in sorted(ROOT.glob(pattern))
    ]
    found *= 3  # raises the share of whole files, because the pages have many short examples
    for page in sorted((ROOT / "docs").glob("*.md")):
        found += [(ROOT / "examples", block) for block in _BLOCK.findall(page.read_text(encoding="utf-8"))]
    return tuple(found)


def drawn(seed: int) -> tuple[Path, str]:
    """Draw a text, and return it with the folder that it belongs to."""
    draw = random.Random(f"texts {seed}")
    folder, text = draw.choice(programs())
    for _ in range(draw.choice((1, 1, 1, 2, 2, 3, 5, 8, 20))):
        text = draw.choice(MUTATIONS)(text, draw)[:LONGEST]
    return folder, text


def _place(text, draw):
    return draw.randint(0, len(text))


def _character(draw):
    return draw.choice(
        (draw.choice(FOREIGN), draw.choice(SIGNS), draw.choice(PIECES), chr(draw.randrange(0x110000)))
    )


def character_deleted(text, draw):
    at = _place(text, draw)
    return text[:at] + text[at + draw.choice((1, 1, 1, 2, 5)) :]


def character_put_in(text, draw):
    at = _place(text, draw)
    return text[:at] + _character(draw) * draw.choice((1, 1, 1, 2, 3)) + text[at:]


def character_doubled(text, draw):
    at = _place(text, draw)
    return text[:at] + text[at : at + 1] * draw.choice((2, 2, 3, 60)) + text[at + 1 :]


def characters_swapped(text, draw):
    at = _place(text, draw)
    return text[:at] + text[at + 1 : at + 2] + text[at : at + 1] + text[at + 2 :]


def character_replaced(text, draw):
    at = _place(text, draw)
    return text[:at] + _character(draw) + text[at + 1 :]


def all_of_one_replaced(text, draw):
    """Replace all occurrences of one character, as editors and word processors do."""
    old, new = draw.choice(
        ((" ", "\u00a0"), (" ", "\u3000"), ("-", "\u2212"), ("-", "\u2013"), ('"', "\u201c"), ("\n", "\r"),
            ("\n", "\r\n"), ("\n", "\u2028"), ("\n", "\x85"),
         (" ", "\t"), (" ", ""), (" ", "\u200b "), (".", ","), ("{", "("), ("0", "O"), ("\n", ("\n"
             "\ufeff")), ("\n", " "), ("P", "\u0420"))
    )  # fmt: skip
    return text.replace(old, new)


def made_wide(text, draw):
    begin = _place(text, draw)
    end = min(len(text), begin + draw.choice((1, 5, 40)))
    wide = "".join(chr(ord(one) + 0xFEE0) if "!" <= one <= "~" else one for one in text[begin:end])
    return text[:begin] + wide + text[end:]


def _token(text, draw):
    found = list(_TOKEN.finditer(text)) or [re.search("", text)]
    return draw.choice(found)


def token_deleted(text, draw):
    token = _token(text, draw)
    return text[: token.start()] + text[token.end() :]


def token_doubled(text, draw):
    token = _token(text, draw)
    return (
        text[: token.end()]
        + draw.choice((" ", ""))
        + token[0] * draw.choice((1, 1, 30))
        + text[token.end() :]
    )


def tokens_swapped(text, draw):
    first, second = sorted((_token(text, draw), _token(text, draw)), key=lambda one: one.start())
    if first.end() > second.start():
        return text
    between = text[first.end() : second.start()]
    return text[: first.start()] + second[0] + between + first[0] + text[second.end() :]


def token_replaced(text, draw):
    token = _token(text, draw)
    known = words()
    kinds = (
        PIECES,
        known.commands,
        known.suffixes,
        known.options,
        known.declarations,
        known.blocks,
        known.functions,
        known.units,
    )
    return text[: token.start()] + draw.choice(draw.choice(kinds)) + text[token.end() :]


def _lines(text):
    return text.split("\n")


def line_deleted(text, draw):
    lines = _lines(text)
    del lines[draw.randrange(len(lines))]
    return "\n".join(lines)


def line_doubled(text, draw):
    lines = _lines(text)
    at = draw.randrange(len(lines))
    lines[at:at] = [lines[at]] * draw.choice((1, 1, 2, 100))
    return "\n".join(lines)


def lines_swapped(text, draw):
    lines = _lines(text)
    one, other = draw.randrange(len(lines)), draw.randrange(len(lines))
    lines[one], lines[other] = lines[other], lines[one]
    return "\n".join(lines)


def lines_joined(text, draw):
    lines = _lines(text)
    at = draw.randrange(len(lines))
    lines[at : at + 2] = ["".join(lines[at : at + 2])]
    return "\n".join(lines)


def cut_off(text, draw):
    at = _place(text, draw)
    return text[:at] if draw.random() < 0.5 else text[at:]


def spliced(text, draw):
    """Join the beginning of one program and the end of another one."""
    other = draw.choice(programs())[1]
    return text[: _place(text, draw)] + other[_place(other, draw) :]


def part_of_another_put_in(text, draw):
    other = draw.choice(programs())[1]
    begin = _place(other, draw)
    at = _place(text, draw)
    return text[:at] + other[begin : begin + draw.choice((3, 30, 300))] + text[at:]


def nested(text, draw):
    depth = draw.choice((1, 3, 99, 101))
    return "REPEAT 1\n" * depth + text + "END\n" * draw.choice((depth, depth - 1))


def repeated(text, draw):
    return text * draw.choice((2, 5, 50))


MUTATIONS = (
    character_deleted, character_put_in, character_put_in, character_doubled, characters_swapped,
        character_replaced, character_replaced,
    all_of_one_replaced, made_wide, token_deleted, token_doubled, tokens_swapped, token_replaced,
        token_replaced, line_deleted, line_doubled,
    lines_swapped, lines_joined, cut_off, spliced, part_of_another_put_in, nested, repeated,
)  # fmt: skip


def comments_of(text):
    return [
        line[len(code) :].rstrip()
        for line in SourceFile("", text).lines
        if len(code := code_of(line)) < len(line)
    ]


class EndlessError(BaseException):
    """Raised if a request takes too long; as no Exception, it can't be turned into a finding."""


@contextmanager
def at_most(seconds: float):
    """Raise EndlessError after this processor time [s]."""

    def give_up(*_):
        raise EndlessError

    before = signal.signal(signal.SIGPROF, give_up)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def _is_cut(checked: Checked) -> bool:
    program = checked.begun.program.value
    return program is not None and program.is_cut


def _placed(finding: Diagnostic) -> tuple[str, Span | None]:
    return finding.code, finding.span


class Laws:
    """Laws that must hold for any text. The checker keeps what an editor's server keeps between texts."""

    def __init__(self) -> None:
        self.analysts = {robot: Analyst(Options(robot=robot)) for robot in (None, "INDUSTRIAL6")}
        self.seconds = 0.0
        self.unrolls_far = False

    def broken(self, seed: int, folder: Path, text: str) -> list[str]:
        """Return the laws that a text breaks, in words.

        Afterwards, `seconds` has the time of the check without planning [s], and `unrolls_far` is true if
        loops with many passes explain this time.
        """
        source = SourceFile(str(folder / "test.yarc"), text)
        try:
            with at_most(PATIENCE):
                checked = self._timed(source, folder)
        except EndlessError:
            self.seconds, self.unrolls_far = PATIENCE, "REPEAT" in text.upper()
            return []
        try:
            with at_most(2 * ALL_PATIENCE if self.unrolls_far else ALL_PATIENCE):
                found = self._broken(seed, source, folder, checked)
        except EndlessError:
            return ["something that is asked of the text has no end"]
        return [*found, *self._planned(source, checked)] if seed % PLANNED == 0 else found

    def _planned(self, source: SourceFile, checked: Checked) -> list[str]:
        """Return the broken laws of a planned text; if planning takes too long, none."""
        try:
            with at_most(PATIENCE):
                return self._of_findings(source, check_further(checked))
        except EndlessError:
            return []

    def _broken(self, seed: int, source: SourceFile, folder: Path, checked: Checked) -> list[str]:
        text = source.text
        found = [*self._of_findings(source, checked), *_of_form(source), *_of_colours(text)]
        draw = random.Random(seed)
        again = self.analysts[_robot_of(text)].analyse(source, folder, quick=True)
        # a quick analysis unrolls fewer passes of loops, and so reports a finding fewer times
        told = _told if again.checked.begun is None or not _is_cut(again.checked) else _placed
        if [*map(told, again.diagnostics)] != [*map(told, checked.diagnostics)]:
            found.append("the server's analyst finds something else")
        view = View(
            sketch_of(source),
            again.checked,
            None if checked.opened is None else checked.opened.request.robot,
            LIBRARY,
        )
        ask_all(view)
        lines = source.lines
        for _ in range(3):
            line = draw.randint(1, len(lines) + 1)
            ask_here(view, line, draw.randint(1, len(source.line(line)) + 1))
        return found

    def _timed(self, source: SourceFile, folder: Path) -> Checked:
        parsing._placed.cache_clear()
        parsing.parse_statement.cache_clear()
        begin = time.process_time()
        checked = check_text(source, folder, Options(robot=_robot_of(source.text)), plans=False)
        self.seconds = time.process_time() - begin
        steps = len(checked.program.steps) if checked.program is not None else 0
        self.unrolls_far = steps > MANY_STEPS
        return checked

    def _of_findings(self, source: SourceFile, checked: Checked) -> list[str]:
        found = []
        for one in checked.diagnostics:
            if one.family == YARCLANG:
                found.append(f"{one.message}\n{one.help}")
            (one.message + one.help).encode("utf-8")
            if not one.message or len(one.message) > LONGEST_MESSAGE:
                found.append(f"{one.code} is told in {len(one.message)} characters: {one.message[:200]}")
            if one.source is source and one.span is not None and not _is_in(one.span, source):
                found.append(f"{one.code} stands at {one.span}, which isn't in the text")
            if one.fix is not None and one.source is source:
                edited(source, [one.fix]).encode("utf-8", "surrogatepass")
        return found


def _robot_of(text: str) -> str | None:
    """Return the robot option for a text: None if it names its own robot, else the robot of most programs."""
    return None if re.search(r"^[ \t]*ROBOT\b", text, re.MULTILINE) else "INDUSTRIAL6"


def _told(one):
    return one.code, one.message, one.help, one.span, one.place, one.fix


def _is_in(span, source):
    last = len(source.lines) + 1
    return (
        1 <= span.line <= span.end_line <= last
        and 1 <= span.column <= len(source.line(span.line)) + 1
        and 1 <= span.end_column <= max(len(source.line(span.end_line)), 1) + 2
        and (span.line, span.column) <= (span.end_line, span.end_column)
    )


def _of_form(source: SourceFile) -> list[str]:
    """Return the broken laws of formatting: fmt either refuses, or keeps words and comments and changes
    nothing when repeated.
    """
    for renumber in (None, (10, 10)):
        made = usual_form(source, renumber)
        if made.value is None:
            ours = [one.message for one in made.diagnostics if one.family == YARCLANG]
            if ours:
                return ours
            continue
        again = usual_form(SourceFile(source.name, made.value), renumber)
        if again.value != made.value:
            return ["the form changes the second time"]
        if comments_of(made.value) != comments_of(source.text):
            return ["the form has other comments"]
    return []


def _of_colours(text: str) -> list[str]:
    pieces = list(YarcLexer().get_tokens_unprocessed(text))
    return [] if "".join(piece for _, _, piece in pieces) == text else ["the lexer loses something"]
