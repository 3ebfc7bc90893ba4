"""The checklist of a robot before its first motion: each item states a verdict, the observation, and the
remedy.
"""

from yarclang.robot.checklist.item import Item, Verdict
from yarclang.robot.checklist.whole import Checklist, check_robot

__all__ = ["Checklist", "Item", "Verdict", "check_robot"]
