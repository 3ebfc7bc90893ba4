"""Roles, and the role that each order needs."""

from __future__ import annotations

from enum import Enum
from typing import Any

from yarclang.coordinator.messages import orders, wants
from yarclang.coordinator.messages.orders import Order


class Role(Enum):
    """Rights of a user. Each role includes the rights of all roles before it."""

    VIEWER = "viewer"
    """Watch, and stop the robot."""
    OPERATOR = "operator"
    """Run, hold and resume the programs of the project."""
    PROGRAMMER = "programmer"
    """Jog, teach, edit, set outputs."""
    SERVICE = "service"
    """Calibrate, change limits, manage users and the system."""

    def covers(self, other: Role) -> bool:
        """Return True if this role has all rights of another one."""
        return _ORDER.index(self) >= _ORDER.index(other)


_ORDER = tuple(Role)

NEEDS: dict[type[Order[Any]], Role] = {
    # A stop on the path does no harm. Whoever sees something go wrong must be able to stop the robot without
    # a login as another user.
    orders.Stop: Role.VIEWER,
    orders.AskStatus: Role.VIEWER,
    orders.AskPlace: Role.VIEWER,
    orders.AskFrames: Role.VIEWER,
    orders.AskHealth: Role.VIEWER,
    orders.AskSurroundings: Role.VIEWER,
    orders.Read: Role.VIEWER,
    orders.AskDeclarations: Role.VIEWER,
    orders.AskParts: Role.VIEWER,
    orders.AskModel: Role.VIEWER,
    orders.AskScene: Role.VIEWER,
    orders.AskCourse: Role.VIEWER,
    orders.Hold: Role.OPERATOR,
    orders.Resume: Role.OPERATOR,
    orders.Step: Role.OPERATOR,
    orders.Abort: Role.OPERATOR,
    orders.Override: Role.OPERATOR,
    orders.Own: Role.OPERATOR,
    orders.Give: Role.OPERATOR,
    orders.Release: Role.OPERATOR,
    orders.Clear: Role.OPERATOR,
    orders.Look: Role.OPERATOR,
    orders.Connect: Role.OPERATOR,
    orders.Enable: Role.OPERATOR,
    orders.Disable: Role.OPERATOR,
    orders.AskHoming: Role.OPERATOR,
    orders.AskSettings: Role.OPERATOR,
    orders.Home: Role.SERVICE,
    orders.SendSettings: Role.SERVICE,
    orders.SaveSettings: Role.SERVICE,
    orders.Load: Role.OPERATOR,
    orders.AskWay: Role.OPERATOR,
    orders.OfferRecovery: Role.OPERATOR,
    orders.Run: Role.OPERATOR,
    orders.Fill: Role.PROGRAMMER,
    orders.SetOutput: Role.PROGRAMMER,
    orders.SetInput: Role.PROGRAMMER,
    orders.PlacePart: Role.PROGRAMMER,
    orders.Adopt: Role.PROGRAMMER,
    orders.Offer: Role.PROGRAMMER,
    orders.OfferBack: Role.PROGRAMMER,
    orders.Go: Role.PROGRAMMER,
    orders.Keep: Role.PROGRAMMER,
    orders.Save: Role.PROGRAMMER,
    **dict.fromkeys(wants.KINDS, Role.PROGRAMMER),
    orders.Steer: Role.PROGRAMMER,
    orders.Leave: Role.PROGRAMMER,
}
"""Role that each order of the API requires. Orders that aren't listed here are refused, such as `hello` and
`listen`, which only the pendant's server itself sends to the coordinator.
"""

WITH_PIN: tuple[type[Order[Any]], ...] = (orders.Home, orders.SendSettings, orders.SaveSettings)
"""Orders that need the PIN as well."""

AUDITED: tuple[type[Order[Any]], ...] = (
    orders.Stop,
    orders.Hold,
    orders.Resume,
    orders.Step,
    orders.Abort,
    orders.Override,
    orders.Own,
    orders.Give,
    orders.Release,
    orders.Clear,
    orders.Connect,
    orders.Enable,
    orders.Disable,
    orders.Home,
    orders.SendSettings,
    orders.SaveSettings,
    orders.Run,
    orders.Fill,
    orders.SetOutput,
    orders.SetInput,
    orders.PlacePart,
    orders.Adopt,
    orders.Go,
)
"""Orders that are written to the audit trail. The start of each jog is written as well."""


_OTHERWISE = {"text", "start", "tolerance", "tm", "cell", "source"}
"""Fields of the order `load` that operators can't set. With these fields, an order could load a program that
isn't saved in the project, or prove a program with settings other than the project's.
"""


def needed_for(order: Order[Any]) -> Role | None:
    """Return the role that an order requires; None if the order can't be given at a pendant."""
    if isinstance(order, orders.Load) and order.model_fields_set & _OTHERWISE:
        return Role.PROGRAMMER  # operators may run the project's programs only as saved
    return NEEDS.get(type(order))
