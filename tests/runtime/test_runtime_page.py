"""Test that docs/runtime.md shows the code's transition table."""

import re
from pathlib import Path

from yarclang.runtime.state import TRANSITIONS

PAGE = Path(__file__).resolve().parents[2] / "docs" / "runtime.md"
_STATES = re.compile(r"(?<=<!-- states -->\n).*?(?=<!-- /states -->)", re.DOTALL)


def drawn():
    arrows = {}
    for state, events in TRANSITIONS.items():
        for event, then in events.items():
            if then is not state:
                arrows.setdefault((state.value, then.value), []).append(event.value)
    diagram = [f"    {a} --> {b}: {', '.join(events)}" for (a, b), events in arrows.items()]
    names = [event.value for event in dict.fromkeys(e for events in TRANSITIONS.values() for e in events)]
    table = [f"| | {' | '.join(names)} |", "|" + "---|" * (len(names) + 1)]
    for state, events in TRANSITIONS.items():
        by_name = {event.value: then.value for event, then in events.items()}
        table.append(f"| **{state.value}** | {' | '.join(by_name.get(name, '') for name in names)} |")
    return "\n".join(
        ["", "```mermaid", "stateDiagram-v2", "    [*] --> disconnected", *diagram, "```", "", *table, "", ""]
    )


def test_the_page_draws_the_table_of_the_code(rewrite_golden):
    text = PAGE.read_text(encoding="utf-8")
    if rewrite_golden:
        PAGE.write_text(_STATES.sub(lambda _: drawn(), text), encoding="utf-8")
        return
    assert _STATES.search(text)[0] == drawn()
