"""URDFs with traps, as they occur in practice, with the lengths of large arms and cobots. Their poses are
computed by Pinocchio from the same text.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin

Z, Y, X = (0, 0, 1), (0, 1, 0), (1, 0, 0)
LARGE = (  # similar to an arm for 180 kg with a reach of 2.55 m: 780, 320, 1075, 200, 1142.5, 200 mm
    ("joint_1", "base_link", "link_1", (0, 0, 0.78), Z),
    ("joint_2", "link_1", "link_2", (0.32, 0, 0), Y),
    ("joint_3", "link_2", "link_3", (0, 0, 1.075), Y),
    ("joint_4", "link_3", "link_4", (0, 0, 0.2), X),
    ("joint_5", "link_4", "link_5", (1.1425, 0, 0), Y),
    ("joint_6", "link_5", "link_6", (0.2, 0, 0), X),
)
LIMIT = '<limit lower="-2.5" upper="2.5" velocity="2" effort="{effort}"/>'


def link(name: str, inside: str = "", shape: bool = True) -> str:
    body = '<collision><geometry><sphere radius="0.02"/></geometry></collision>' if shape else ""
    return f'<link name="{name}">{body}{inside}</link>'


def joint(name, parent, child, xyz=(0, 0, 0), axis=Z, kind="revolute", more="", rpy=(0, 0, 0), effort=500):
    place = f'<origin xyz="{xyz[0]} {xyz[1]} {xyz[2]}" rpy="{rpy[0]} {rpy[1]} {rpy[2]}"/>'
    moves = "" if kind == "fixed" else f'<axis xyz="{axis[0]} {axis[1]} {axis[2]}"/>'
    limit = LIMIT.format(effort=effort) if kind in ("revolute", "prismatic") else ""
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{place}{moves}{limit}{more}</joint>'


def arm(prefix: str = "", effort: float = 500, base: tuple[str, str] = ("", "")) -> str:
    """Return the URDF of six joints, flange and tool0 by REP 199. With `base`, a joint leads from the link
    base[0], which isn't declared here, to base_link.
    """

    def at(name):
        return f"{prefix}{name}"

    parts = [link(at("base_link"))]
    if base[0]:
        parts.append(joint(at("foot"), base[0], at("base_link"), kind=base[1] or "fixed"))
    for name, parent, child, xyz, axis in LARGE:
        parts += [link(at(child)), joint(at(name), at(parent), at(child), xyz, axis, effort=effort)]
    parts += [
        link(at("flange"), shape=False),
        joint(at("to_flange"), at("link_6"), at("flange"), kind="fixed"),
    ]
    parts += [link(at("tool0"), shape=False)]
    parts += [joint(at("to_tool0"), at("flange"), at("tool0"), kind="fixed", rpy=(0, 1.5707963, 0))]
    return "".join(parts)


def robot(*parts: str, name: str = "trap") -> str:
    return f'<robot name="{name}" version="1.1">{"".join(parts)}</robot>'


def follows(leader: str, factor: float = 1.0) -> str:
    return f'<mimic joint="{leader}" multiplier="{factor}" offset="0"/>'


ROD = link("rod") + joint("rod_joint", "link_1", "rod", (0.1, 0, 0), Y, more=follows("joint_2"))
WEIGHT = link("weight") + joint(
    "weight_joint", "link_1", "weight", (-0.4, 0, 0), Y, more=follows("joint_3", -1)
)
CYLINDER = link("cylinder") + joint(
    "joint_2-cylinder", "link_1", "cylinder", (-0.3, 0, 0.1), Y, more=follows("joint_2", -0.5)
)
HAND = link("palm") + joint("to_palm", "tool0", "palm", (0, 0, 0.05), kind="fixed")
HAND += link("left") + joint("drive", "palm", "left", (0, 0.03, 0.1), Y, kind="prismatic")
HAND += link("right") + joint(
    "right_drive", "palm", "right", (0, -0.03, 0.1), Y, kind="prismatic", more=follows("drive", -1)
)


def poses(text: str, base: str, flange: str, names, q) -> np.ndarray:
    """Return base_from_flange (N, 4, 4) by Pinocchio, for the original URDF with its <mimic> joints."""
    model = pin.buildModelFromXML(text)
    state = model.createData()
    ends = [model.getFrameId(end, pin.FrameType.BODY) for end in (base, flange)]
    found = np.empty((len(q), 4, 4))
    for row, values in enumerate(q):
        full = pin.neutral(model)
        for name, value in zip(names, values, strict=True):
            moved = model.joints[model.getJointId(name)]
            # for a joint without limits, Pinocchio uses cosine and sine
            turn = (np.cos(value), np.sin(value))
            full[moved.idx_q : moved.idx_q + moved.nq] = turn if moved.nq == 2 else value
        pin.framesForwardKinematics(model, state, full)
        found[row] = (state.oMf[ends[0]].inverse() * state.oMf[ends[1]]).homogeneous
    return found


def written(folder: Path, text: str, name: str = "arm.urdf") -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name
