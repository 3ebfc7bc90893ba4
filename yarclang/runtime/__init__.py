"""Communication with a controller.

A run executes scripts (`scripts.py`). A script is a generator that yields actions (`actions.py`); all scripts
of a run share an operation (`operation.py`) with its state (`state.py`). Each kind of controller brings its
own scripts, as `pmac/` does. `session.py` executes the scripts over `transports/`. A run executes a job
(`job.py`) or a live motion (`live.py`). The values that a run reports are defined in `notices.py`,
`sample.py`, `signals.py`, `standing.py`, `inspection.py` and `outcome.py`; the log stores these values
(`log.py`, `log_record.py`).
"""
