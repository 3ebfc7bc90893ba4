"""Test that an event is encoded only once, for any number of clients."""

from yarclang.coordinator import serving
from yarclang.coordinator.messages.events import Told
from yarclang.coordinator.messages.lines import write_event
from yarclang.coordinator.serving import Written


def test_an_event_is_written_once_for_all_who_are_told(monkeypatch):
    made = []
    monkeypatch.setattr(serving, "write_event", lambda event: made.append(event) or write_event(event))
    written, event = Written(), Told(time_s=1.0, text="once", warning=False)
    lines = [written.line(event) for _ in range(8)]
    assert set(lines) == {write_event(event)}
    assert made == [event]


def test_events_that_are_alike_or_many_have_lines_of_their_own():
    written = Written()
    for number in range(1000):
        event = Told(time_s=1.0, text=str(number), warning=False)
        assert written.line(event) == write_event(event)
    assert len(written._lines) <= serving._LINES
