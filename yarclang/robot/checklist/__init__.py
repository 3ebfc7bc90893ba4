"""Check a robot before it moves: each item with a verdict, the observation, and what to do."""

from yarclang.robot.checklist.item import Item, Verdict
from yarclang.robot.checklist.whole import Checklist, check_robot

__all__ = ["Checklist", "Item", "Verdict", "check_robot"]
