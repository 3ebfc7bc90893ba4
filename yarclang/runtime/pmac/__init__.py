"""How a Turbo PMAC is talked to: looked at, streamed to, brought to rest. None of it does I/O.

`scripts.py` lists the scripts. `protocol.py` is the codec, of `messages.py` and `packets.py`; `operation.py`
asks, `feedback.py` reads what is answered. `performance.py` is a run from its first question to its last: it
looks (`inspection.py`, `memory.py`, `picture.py`, `link.py`, `pace.py`), streams a job (`streaming.py`,
`legs.py`) through the rotary (`rotary.py`, `feed.py`, `loading.py`) or a live motion (`live.py`), and holds
(`holding.py`). While it moves, `watching.py` asks, `supervision.py` and `course.py` compare with what was
proved, `outputs.py` knows safe values. `rest.py` and `idling.py` are rest, `servicing.py` and `homing.py`
service.
"""
