"""Read the tables of a robot.toml that may have mistakes, so that its correct values can be checked."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from yarclang.robot.kinds import DEFAULT
from yarclang.robot.schema import JointTable, RampsTable, RobotTable, robot_table
from yarclang.toml.draft import Draft, missing_mistake
from yarclang.toml.draft import read_draft as read_any
from yarclang.units import MS

RobotDraft = Draft[RobotTable]


def read_draft(data: dict[str, Any]) -> RobotDraft:
    """Return the tables of a robot.toml, without the keys whose values have the wrong type or form.

    Args:
        data: the dictionary from tomllib. Keys whose values have the wrong type or form are removed from it.
    """
    told = data.get("controller")
    kind = told.get("kind", DEFAULT) if isinstance(told, dict) else DEFAULT
    draft = _ramped(read_any(data, robot_table(kind if isinstance(kind, str) else DEFAULT)))
    positions, home = draft.table.positions, ("positions", "HOME")
    if positions is None or home in draft.dropped or "HOME" in (name.upper() for name in positions):
        return draft
    return replace(draft, mistakes=(*draft.mistakes, missing_mistake(RobotTable, home)))


def _ramped(draft: RobotDraft) -> RobotDraft:
    """Return the draft with the missing accelerations and jerks of its joints computed from the table
    [ramps]. These keys are then no longer reported as missing.
    """
    ramps, joints = draft.table.ramps, draft.table.joints
    if ramps is None or joints is None:
        return draft
    filled = {name: _with_ramps(joint, ramps) for name, joint in joints.items()}
    ruled = {"acceleration": ramps.rise, "jerk": ramps.ease}
    given = [("joints", name, key) for name in joints for key, time in ruled.items() if time is not None]
    mistakes = tuple(one for one in draft.mistakes if one.code != "Y1304" or one.path not in given)
    return replace(draft, table=draft.table.model_copy(update={"joints": filled}), mistakes=mistakes)


def _with_ramps(joint: JointTable, ramps: RampsTable) -> JointTable:
    """Return a joint's table with its missing acceleration and jerk computed, if the joint's velocity and the
    ramp times are known.
    """
    acceleration, jerk = joint.acceleration, joint.jerk
    if acceleration is None and joint.velocity is not None and ramps.rise is not None:
        acceleration = joint.velocity / (ramps.rise * MS)
    if jerk is None and acceleration is not None and ramps.ease is not None:
        jerk = acceleration / (ramps.ease * MS)
    return joint.model_copy(update={"acceleration": acceleration, "jerk": jerk})
