"""Draw the workspace of an arm: for each position, in how many orientations the arm can hold its flange."""

from __future__ import annotations

import numpy as np

from yarclang.report.pictures.plot import Format, saved
from yarclang.report.pictures.style import picture_style
from yarclang.robot.holding import sections
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.model import Robot


def draw_held(robot: Robot, format_: Format) -> bytes:
    """Return the picture of a robot's workspace. Equal robots give equal bytes."""
    from matplotlib.figure import Figure

    with picture_style():
        figure = Figure(figsize=(16, 10), dpi=100, layout="constrained")
        home = flange_poses(robot.chain, robot.home[None])[0, :3, 3]
        places = ((float(np.hypot(home[0], home[1])), home[2]), (home[0], home[1]))
        for axes, section, (across, up) in zip(figure.subplots(1, 2), sections(robot), places, strict=True):
            drawn = axes.pcolormesh(
                section.across * 1e3,
                section.up * 1e3,
                section.share * 100.0,
                vmin=0.0,
                vmax=100.0,
                cmap="viridis",
            )
            axes.plot(across * 1e3, up * 1e3, "r+", markersize=14, label="HOME")
            axes.plot(0.0, 0.0, "k^", label="{B}")
            axes.set_aspect("equal")
            axes.set_xlabel(f"{section.axes[0]} [mm]")
            axes.set_ylabel(f"{section.axes[1]} [mm]")
            axes.legend(loc="upper right")
        figure.colorbar(drawn, ax=figure.axes, shrink=0.7, label="orientations of the flange [% of 24]")
        names = ", ".join(robot.joint_names[:9])
        figure.suptitle(f"{robot.name}: {robot.size} joints ({names})"[:150])
        return saved(figure, format_)
