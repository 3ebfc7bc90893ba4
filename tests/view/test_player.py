"""Tests of the displayed time, and of lists of which one page is shown."""

from hypothesis import given
from hypothesis import strategies as st

from yarclang.view.listing import Listing
from yarclang.view.player import Player


def test_it_plays_to_its_end_and_begins_anew():
    player = Player(2.0)
    assert not player.pass_by(1.0)  # the player is paused
    player.press()
    player.factor = 0.5
    assert player.pass_by(1.0)
    assert (player.time, player.plays) == (0.5, True)
    assert player.pass_by(10.0)
    assert (player.time, player.plays) == (2.0, False)
    player.press()
    assert (player.time, player.plays) == (0.0, True)
    player.press()
    assert not player.plays


def test_nothing_to_play():
    player = Player(0.0)
    player.press()
    assert not player.plays


@given(
    st.floats(0.0, 100.0),
    st.lists(st.one_of(st.none(), st.floats(-200, 200), st.floats(0, 200).map(lambda x: (x,)))),
)
def test_the_time_stays_within(duration, deeds):
    player = Player(duration)
    for deed in deeds:
        if deed is None:
            player.press()
        elif isinstance(deed, tuple):
            player.pass_by(deed[0])
        else:
            player.jump(deed)
        assert 0.0 <= player.time <= duration


def test_a_listing_has_pages_and_finds():
    rows = [f"P{number:04} MOVE{'L' if number % 2 else 'J'}" for number in range(1, 26)]
    listing = Listing(rows, 10)
    assert (listing.pages, listing.shown) == (3, list(range(10)))
    listing.turn(5)
    assert listing.shown == [20, 21, 22, 23, 24]
    listing.follow(3)
    assert listing.page == 0
    listing.choose(" movel")
    assert (listing.pages, len(listing.chosen)) == (2, 13)
    assert all("MOVEL" in rows[row] for row in listing.shown)
    listing.follow(1)  # row 1 is a MOVEJ, which isn't among the chosen rows
    assert listing.page == 0
    listing.choose("nothing has this")
    assert (listing.pages, listing.shown) == (1, [])
