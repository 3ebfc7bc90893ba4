"""Write docs/findings.md: the meaning of every finding, and its remedy."""

from __future__ import annotations

from yarclang.findings import FAMILIES, Finding
from yarclang.lint.registry import everything, rules

_READS = {
    "Module": "the text",
    "Program": "the checked program",
    "MotionPlan": "the plan",
    "Certificate": "the certificate",
}
_FILES = {"11": "text", "13": "toml", "14": "text", "15": "text", "16": "text"}
"""Languages of the examples in families of findings whose examples aren't programs."""


def findings_page(introduction: str) -> str:
    """Return the page in Markdown: an introduction, and the findings by family."""
    parts = [introduction.rstrip(), ""]
    for family, title in FAMILIES.items():
        entries = [one for one in everything().values() if one.family == family]
        if entries:
            parts += [f"## {family}: {title}", ""]
        for one in entries:
            parts += _entry(one)
    return "\n".join(parts).rstrip() + "\n"


def _entry(finding: Finding) -> list[str]:
    read = next((_READS[rule.reads.__name__] for rule in rules() if rule.finding is finding), None)
    kind = f"{finding.severity}, a rule that reads {read}" if read else finding.severity
    lines = [f"### {finding.code} {finding.name}", "", f"*{kind}*: {finding.title}.", "", finding.why, ""]
    language = _FILES.get(finding.family, "yarc")
    for title, text in (("For example:", finding.example), ("Better:", finding.better)):
        if text:
            lines += [title, "", f"```{language}", text, "```", ""]
    return lines
