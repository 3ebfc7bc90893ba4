"""Describe the frames and mounted tools of robot.toml as links of a URDF, since the robot's URDF doesn't
contain them.
"""

from __future__ import annotations

from collections.abc import Mapping

from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot, Tool
from yarclang.robot.urdf import Urdf


@frozen(eq=False)
class Bodies:
    """Additional links on the flange, for frames and mounted tools.

    Attributes:
        frames: flange_from_frame (4, 4) [m], by the name of the link.
        tools: mounted tools, by the name of the link. The poses of their shapes are relative to the flange.
    """

    frames: Mapping[str, Array]
    tools: Mapping[str, Tool]

    @property
    def links(self) -> tuple[str, ...]:
        """Names of all additional links."""
        return *self.frames, *self.tools

    def link_of(self, body: str) -> str:
        """Return the name of the URDF link that represents a body of the robot. For a tool, this is the
        additional link; for a link, it is the link itself.
        """
        return next((link for link, tool in self.tools.items() if tool.name == body), body)


def bodies_of(robot: Robot, urdf: Urdf) -> Bodies:
    """Return additional links for the frames and mounted tools of a robot.

    Each link is named after its frame or tool in lower case. If a link or joint of the URDF already has this
    name, `_frame` or `_body` is appended.
    """
    taken = {name.lower() for name in (*urdf.links, *urdf.joints)}

    def named(name: str, ending: str) -> str:
        link = name.lower()
        while link in taken or f"{link}_joint" in taken:
            link += ending
        taken.update((link, f"{link}_joint"))
        return link

    frames = {
        named(name, "_frame"): pose for name, pose in robot.flange_from_frame.items() if name != "FLANGE"
    }
    tools = {named(tool.name, "_body"): tool for tool in robot.tools if tool.mounted}
    return Bodies(frames, tools)
