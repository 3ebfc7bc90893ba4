"""Tests of docs/findings.md: it says what the catalogue and the rules say, and its examples of settings and
comments work.
"""

import re
from pathlib import Path

from yarclang.lint.registry import everything
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.inputs import Options
from yarclang.report.findings_page import findings_page
from yarclang.source import SourceFile

PAGE = Path(__file__).resolve().parents[2] / "docs" / "findings.md"
LINE = "\n---\n"


def test_the_page_is_what_the_findings_say(rewrite_golden):
    shown = PAGE.read_text(encoding="utf-8")
    today = findings_page(shown.partition(LINE)[0] + LINE)
    if rewrite_golden:
        PAGE.write_text(today, encoding="utf-8")
        shown = today
    assert shown == today
    assert re.findall(r"^### (Y\d{4})", shown, re.MULTILINE) == list(everything())


def test_its_examples_work(tmp_path):
    text = PAGE.read_text(encoding="utf-8")
    settings = re.search(r"```toml\n(.*?)```", text, re.DOTALL)[1]
    program = re.search(r"```yarc\n(.*?)```", text, re.DOTALL)[1]
    (tmp_path / "yarc.toml").write_text(settings)
    (tmp_path / "cell.toml").write_text('units = "mm,deg"\n')
    assert check_text(SourceFile("a.yarc", program), tmp_path, Options()).diagnostics == ()
