"""Random chains with masses: as URDF text, as read by yarclang, and as read by Pinocchio."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from yarclang.robot.chain import joints_between, screws
from yarclang.robot.masses import dynamics_of
from yarclang.robot.model import Tool
from yarclang.robot.urdf import read_urdf
from yarclang.source import SourceFile
from yarclang.transforms import rpy_rotation


def numbers(values):
    return " ".join(f"{value:.9f}" for value in values)


def inertial(random):
    """Return the URDF inertia of a body. It is that of a rotated box."""
    mass, edges = random.uniform(0.1, 8.0), random.uniform(0.02, 0.3, 3)
    turn = rpy_rotation(random.uniform(-3, 3, 3))
    tensor = turn @ np.diag(mass / 12 * (np.sum(edges**2) - edges**2)) @ turn.T
    parts = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    words = " ".join(f'{key}="{tensor[at]:.12g}"' for key, at in parts.items())
    place = (
        f'<origin xyz="{numbers(random.uniform(-0.2, 0.2, 3))}" rpy="{numbers(random.uniform(-3, 3, 3))}"/>'
    )
    return f'<inertial>{place}<mass value="{mass:.9f}"/><inertia {words}/></inertial>'


def urdf_text(random, size):
    """Return the URDF of a chain from `foot` to `flange`, on a pedestal. A further body is fixed to each
    link.
    """

    def joint(name, kind, parent, child, more=""):
        place = f'xyz="{numbers(random.uniform(-0.4, 0.4, 3))}" rpy="{numbers(random.uniform(-3, 3, 3))}"'
        return (
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin '
            f"{place}/>{more}</joint>"
        )

    lines = ['<robot name="heavy" version="1.1">', f'<link name="floor">{inertial(random)}</link>']
    lines += ['<link name="foot"/>', joint("stand", "fixed", "floor", "foot")]
    above = "foot"
    for number in range(1, size + 1):
        kind = "prismatic" if random.random() < 0.25 else "revolute"
        axis = random.normal(size=3)
        more = (
            f'<axis xyz="{numbers(axis / np.linalg.norm(axis))}"/><limit lower="-1" upper="1" velocity="1" '
            f'effort="{random.uniform(1, 90):.6f}"/>'
        )
        lines.append(
            f'<link name="L{number}">{inertial(random)}</link><link '
            f'name="M{number}">{inertial(random)}</link>'
        )
        lines += [
            joint(f"J{number}", kind, above, f"L{number}", more),
            joint(f"F{number}", "fixed", f"L{number}", f"M{number}"),
        ]
        above = f"L{number}"
    lines += ['<link name="flange"/>', joint("end", "fixed", above, "flange"), "</robot>"]
    return "\n".join(lines)


@dataclass
class Heavy:
    """A chain as yarclang reads it, and as Pinocchio reads it."""

    text: str
    chain: object
    dynamics: object
    model: pin.Model

    @property
    def size(self):
        return self.chain.size

    def rnea(self, q, v, a):
        """Return Pinocchio's torques (P, n), with one call for each instant."""
        data = self.model.createData()
        return np.array([pin.rnea(self.model, data, *one) for one in zip(q, v, a, strict=True)])


def heavy(seed, size, tools=(), efforts=None, gravity=None):
    """Return a random chain. In Pinocchio's model, tools are bodies on the flange."""
    random = np.random.default_rng(seed)
    text = urdf_text(random, size)
    urdf = read_urdf(SourceFile("heavy.urdf", text))
    moving = tuple(one for one in joints_between(urdf, "foot", "flange") if one.kind != "fixed")
    chain = screws(urdf, "foot", "flange", moving)
    assert not urdf.findings
    said = (efforts or [None] * size, gravity, True)
    dynamics = dynamics_of(urdf, ("foot", moving), chain, tools, said)
    model = pin.buildModelFromXML(text)
    for tool in tools:
        frame = model.frames[model.getFrameId("flange", pin.FrameType.BODY)]
        if tool.mounted:
            model.appendBodyToJoint(
                frame.parentJoint, pin.Inertia(tool.mass, tool.center, tool.inertia), frame.placement
            )
    if gravity is not None:
        foot = model.frames[model.getFrameId("foot", pin.FrameType.BODY)].placement
        model.gravity.linear = foot.rotation @ np.array(gravity)
    return Heavy(text, chain, dynamics, model)


def tool(mass=3.0, mounted=True):
    """Return a tool with an inertia."""
    return Tool("T", mounted, mass, np.array([0.1, -0.05, 0.2]), np.diag([0.02, 0.03, 0.04]), ())
