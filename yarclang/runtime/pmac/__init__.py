"""Communication with a Turbo PMAC: inspection, streaming, stopping. Nothing here does I/O.

- `scripts.py` lists the scripts.
- `protocol.py` converts `messages.py` to bytes and back, by `packets.py`. `operation.py` asks questions, and
  `feedback.py` reads the answers.
- `performance.py` is a run from its first question to its last. It inspects the controller (`inspection.py`,
  `memory.py`, `picture.py`, `link.py`, `pace.py`), and streams a job (`streaming.py`, `legs.py`) through the
  rotary buffer (`rotary.py`, `feed.py`, `loading.py`) or a live motion (`live.py`). `holding.py` holds and
  resumes a job.
- While the robot moves, `watching.py` asks for its state, `supervision.py` and `course.py` compare the
  answers with what was proved, and `outputs.py` has the safe values.
- `rest.py` and `idling.py` are for a robot at rest, `servicing.py` and `homing.py` for service.
"""
