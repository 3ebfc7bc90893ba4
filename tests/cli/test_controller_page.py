"""docs/controller.md names files that exist, and settings that `yarc settings` writes."""

import re
from pathlib import Path

from yarclang.backend_pmac.settings import settings_text

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "controller.md").read_text(encoding="utf-8")


def test_files_exist():
    names = set(re.findall(r"`([\w/]+\.(?:py|json|yarc))`", PAGE))
    assert len(names) > 30
    assert [
        name for name in names if not any((top / name).exists() for top in (ROOT, ROOT / "yarclang"))
    ] == []


def test_settings_are_printed(industrial6):
    settings = settings_text(industrial6)
    rows = [row for row in PAGE.splitlines() if row.startswith("|") and "settings: " in row]
    shown = {text for row in rows for text in re.findall(r"`(I\d+=\d*|M\d+->|OPEN PLC \d+)`", row)}
    assert len(shown) > 10
    assert [text for text in shown if text not in settings] == []
