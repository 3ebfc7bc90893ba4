"""Tests of caches: their sizes are bounded, and what is in use stays in them."""

from yarclang.assist.lexemes import lexemes_of
from yarclang.assist.sketch import sketch_of
from yarclang.assist.tints import tints
from yarclang.diagnostics import Diagnostic
from yarclang.lsp.documents import Document
from yarclang.lsp.translation import _on_line, diagnostic_of, expect
from yarclang.memory import Lately, Recent, recall
from yarclang.source import SourceFile, Span


def test_results_that_were_not_used_lately_are_forgotten():
    memory = Recent(10)
    for number in range(25):
        recall(memory, number, lambda number=number: str(number))
    assert len(memory) == 10
    assert (memory.get(24), memory.get(15), memory.get(14)) == ("24", "15", None)


def test_what_is_used_again_stays():
    memory = Recent(10)
    for number in range(100):
        recall(memory, number, lambda number=number: str(number))
        recall(memory, "always", lambda: "here")
    assert memory.get("always") == "here"
    assert len(memory) == 10


def test_after_a_large_look_what_is_kept_shrinks_again():
    memory = Recent(10_000)
    for number in range(5_000):
        memory.keep(number, "large")
    memory.settle(100)
    assert len(memory) == 5_000
    sizes = []
    for look in range(100):
        for number in range(30):
            memory.keep((look % 2, number), "small")
        memory.settle(100)
        sizes.append(len(memory))
    assert sizes[-1] == 100
    assert max(sizes) <= 5_060
    assert memory.get((1, 29)) == "small"


def test_no_results_are_lost_by_a_large_look_that_comes_again():
    memory, misses = Recent(10_000), []
    for _ in range(5):
        before = memory.misses
        for number in range(3_000):
            recall(memory, number, lambda: "one")
        memory.settle(100)
        misses.append(memory.misses - before)
    assert misses == [3_000, 0, 0, 0, 0]


def test_a_function_keeps_what_it_has_given_lately():
    made = []

    def make(text, line):
        made.append((text, line))
        return f"{text}{line}"

    function = Lately(make, 10)
    for number in range(1_000):
        assert function("a", number) == f"a{number}"
        assert function("always", 1) == "always1"
        assert len(function) <= 20
    assert made.count(("always", 1)) == 1
    assert len(made) == 1_001


def test_a_long_text_is_kept_whole_until_it_was_read_again():
    made = []
    function = Lately(lambda number: made.append(number) or -number, 10)
    for _ in range(4):
        function.expect(500)
        assert [function(number) for number in range(500)] == [-number for number in range(500)]
    assert len(made) == 500
    function.expect(5)
    for number in range(600, 700):
        function(number)
    assert len(function) <= 20
    function.cache_clear()
    assert len(function) == 0


def test_what_is_kept_of_lines_and_findings_is_bounded_by_the_longest_text():
    document = Document("file:///test.yarc", 1, "P0010 STOP\n" * 10)
    source = document.source
    list(tints(sketch_of(source)))
    expect(10)
    for number in range(10_000):
        lexemes_of(f"P{number:05} MOVEJ HOME")
        diagnostic_of(
            document, Diagnostic("Y0601", str(number), source, Span.on_line(1 + number % 10, 1, 5)), "utf-16"
        )
    assert len(lexemes_of) <= 2_048
    assert len(_on_line) <= 2_048
    long = SourceFile("long.yarc", "".join(f"P{number:05} MOVEJ HOME\n" for number in range(5_000)))
    list(tints(sketch_of(long)))
    assert len(lexemes_of) >= 5_000  # all lines of a long text are kept until its next version
