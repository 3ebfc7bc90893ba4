"""Reading the tables of a robot.toml as far as they can be read."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from yarclang.robot.kinds import DEFAULT
from yarclang.robot.schema import RobotTable, robot_table
from yarclang.toml.draft import Draft, missing_mistake
from yarclang.toml.draft import read_draft as read_any

RobotDraft = Draft[RobotTable]


def read_draft(data: dict[str, Any]) -> RobotDraft:
    """The tables of a robot.toml, without the keys whose values have the wrong form.

    Args:
        data: what tomllib made of the file; bad keys are taken out of it.
    """
    told = data.get("controller")
    kind = told.get("kind", DEFAULT) if isinstance(told, dict) else DEFAULT
    draft = read_any(data, robot_table(kind if isinstance(kind, str) else DEFAULT))
    positions, home = draft.table.positions, ("positions", "HOME")
    if positions is None or home in draft.dropped or "HOME" in (name.upper() for name in positions):
        return draft
    return replace(draft, mistakes=(*draft.mistakes, missing_mistake(RobotTable, home)))
