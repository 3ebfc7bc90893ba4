"""What is to be looked at before a robot moves: each point with a verdict, what was found, and what to do."""

from yarclang.robot.checklist.item import Item, Verdict
from yarclang.robot.checklist.whole import Checklist, check_robot

__all__ = ["Checklist", "Item", "Verdict", "check_robot"]
