"""Talking to a controller.

A run is made of scripts (`scripts.py`), generators that yield actions (`actions.py`) and share an operation
(`operation.py`) with its state (`state.py`); each kind of controller brings its own, as `pmac/` does.
`session.py` carries them out over `transports/`. What is run is a job (`job.py`) or a live motion
(`live.py`). What is told: `notices.py`, `sample.py`, `signals.py`, `standing.py`, `inspection.py`,
`outcome.py`; the log keeps it (`log.py`, `log_record.py`).
"""
