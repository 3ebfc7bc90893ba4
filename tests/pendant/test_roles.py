"""Tests of the roles that orders need."""

import pytest

from yarclang.coordinator.messages import orders, wants
from yarclang.pendant.accounts.roles import AUDITED, NEEDS, WITH_PIN, Role, needed_for

OWN = {orders.Hello, orders.Listen}
"""Orders that only the pendant's server sends to the coordinator."""


def test_every_order_has_its_role():
    """A new order is refused until a role is chosen for it."""
    assert set(NEEDS) | OWN == {*orders.KINDS, *wants.KINDS}


@pytest.mark.parametrize("kind", [*orders.KINDS, *wants.KINDS])
def test_what_changes_something_is_for_more_than_viewers(kind):
    asks = {orders.AskStatus, orders.AskPlace, orders.AskFrames, orders.AskHealth, orders.AskSurroundings}
    asks |= {orders.Read, orders.AskDeclarations, orders.AskParts, orders.AskCourse}
    asks |= {orders.AskModel, orders.AskScene}
    role = NEEDS.get(kind)
    assert role is None or role is not Role.VIEWER or kind in asks | {orders.Stop}


def test_what_an_operator_gives_as_text_is_for_programmers():
    assert needed_for(orders.Load(file="a.yarc")) is Role.OPERATOR
    assert needed_for(orders.Load(file="a.yarc", text="")) is Role.PROGRAMMER


@pytest.mark.parametrize(
    "field",
    [{"cell": "empty.toml"}, {"source": "b.yarc"}, {"tolerance": (1000.0,)}, {"start": (0.0,)}, {"tm": 50.0}],
)
def test_what_is_proved_otherwise_is_for_programmers(field):
    """Options that weaken a proof need a programmer: an operator mustn't choose a cell without obstacles, or
    a tolerance of one metre.
    """
    assert needed_for(orders.Load(file="a.yarc", **field)) is Role.PROGRAMMER
    assert (
        needed_for(orders.Load(file="a.yarc", first="P0020", approach=True, by_steps=True)) is Role.OPERATOR
    )


def test_what_moves_the_robot_or_changes_it_is_audited():
    silent = {
        orders.AskStatus,
        orders.AskPlace,
        orders.AskFrames,
        orders.AskHealth,
        orders.AskSurroundings,
        orders.Read,
    }
    silent |= {
        orders.AskDeclarations,
        orders.AskParts,
        orders.AskModel,
        orders.AskScene,
        orders.Look,
        orders.AskHoming,
        orders.AskSettings,
        orders.Load,
        orders.AskWay,
        orders.OfferRecovery,
        orders.Offer,
    }
    silent |= {
        orders.OfferBack,
        orders.AskCourse,
        orders.Keep,
        orders.Save,
        orders.Steer,
        orders.Leave,
        *wants.KINDS,
    }  # jogs have an audit entry of their own
    assert set(AUDITED) == set(NEEDS) - silent


def test_what_moves_without_proof_or_writes_the_controller_needs_the_pin():
    assert all(NEEDS[kind] is Role.SERVICE and kind in AUDITED for kind in WITH_PIN)
    assert {orders.Home, orders.SendSettings, orders.SaveSettings} == set(WITH_PIN)


def test_roles_are_in_order():
    roles = list(Role)
    assert [[one.covers(other) for other in roles] for one in roles] == [
        [True, False, False, False],
        [True, True, False, False],
        [True, True, True, False],
        [True, True, True, True],
    ]
