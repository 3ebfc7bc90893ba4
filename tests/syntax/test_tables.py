"""Tests of the saved tables of the grammar: they are those that Lark generates, and others aren't used."""

import json

import lark
import pytest
from hypothesis import given
from syntax.writing import statement

from yarclang.syntax import parse as parsing
from yarclang.syntax.nodes import Nodes
from yarclang.syntax.parse import GRAMMAR, TABLES, _built, _loaded, _parser, made_tables

TEXTS = ("P1 MOVEJ $(1 + 2*A) 3 [50%]", "LET A = -2**2 (mm)", "CALL X {B} 3 (mm)", "IF A <> 2 AND NOT (B)")
WRONG = ("P1 MOVEJ $(1 + ", "LET = 3", "CALL X [", "P1 MOVEJ [1 2] [3]", "IF A ? B")

is_made_with_this = json.loads(TABLES.read_text())["of"].startswith(f"lark {lark.__version__},")


def canonical(text):
    """Return the tables with states and rules numbered in the order of their use.

    Lark numbers them in random order.
    """
    content = json.loads(text)
    tables, memo = content["data"]["parser"].pop("parser"), content.pop("memo")
    told = {number: json.dumps(one, sort_keys=True) for number, one in memo.items()}
    tokens = tables["tokens"]
    number_of = {tables["start_states"]["statement"]: 0}
    met = list(number_of)
    automaton = []
    for state in met:  # `met` grows during this loop
        actions = {tokens[token]: action for token, action in tables["states"][str(state)].items()}
        row = {}
        for token, (kind, what) in sorted(actions.items()):
            if kind == 0 and what not in number_of:
                number_of[what] = len(met)
                met.append(what)
            row[token] = number_of[what] if kind == 0 else told[str(what["@"])]
        automaton.append(row)
    assert len(met) == len(tables["states"])
    rest = json.dumps(content, sort_keys=True)
    for number, one in told.items():
        rest = rest.replace(f'{{"@": {number}}}', one)
    return automaton, number_of[tables["end_states"]["statement"]], json.loads(rest)


def test_they_are_the_grammars(rewrite_golden):
    if rewrite_golden and (
        not is_made_with_this or canonical(made_tables()) != canonical(TABLES.read_text())
    ):
        TABLES.write_text(made_tables())
    if not is_made_with_this and not rewrite_golden:
        pytest.skip("another version of Lark makes its own tables")
    assert canonical(TABLES.read_text()) == canonical(made_tables())


@pytest.mark.skipif(not is_made_with_this, reason="another version of Lark")
@given(statement)
def test_both_parsers_read_alike(text):
    saved, fresh = _saved_and_fresh()
    assert saved.parse(text) == fresh.parse(text)


def _saved_and_fresh(kept={}):  # noqa: B006  (made once)
    if not kept:
        grammar = GRAMMAR.read_text()
        kept |= {"saved": _loaded(grammar), "fresh": _built(grammar, Nodes())}
    return kept["saved"], kept["fresh"]


@pytest.mark.parametrize("text", [*TEXTS, *WRONG])
def test_faults_are_explained_alike(monkeypatch, text):
    usual = parsing.statement_by_grammar(text)
    monkeypatch.setattr(parsing, "_parser", lambda: _saved_and_fresh()[1])
    assert parsing.statement_by_grammar(text) == usual


@pytest.mark.parametrize("content", [None, "", "[", '{"of": "lark 0.0.0, grammar 0"}'])
def test_tables_of_something_else_are_not_used(monkeypatch, tmp_path, content):
    path = tmp_path / "grammar.json"
    if content is not None:
        path.write_text(content)
    monkeypatch.setattr(parsing, "TABLES", path)
    assert _loaded(GRAMMAR.read_text()) is None
    _parser.cache_clear()
    assert parsing.statement_by_grammar("LET A = 1").name.name == "LET"
    _parser.cache_clear()


def test_a_changed_grammar_has_no_saved_tables():
    assert _loaded(GRAMMAR.read_text() + "\n// changed\n") is None
