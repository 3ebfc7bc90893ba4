"""HTTP routes that return the inputs and outputs and their values. Values are set by other routes: the
orders `set` and `input`.
"""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import Response

from yarclang.pendant.messages.signals import SignalsShown, SignalValues
from yarclang.pendant.web.answers import answer
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service


async def _signals(service: Service, request: Request) -> Response:
    service.session(request)
    return answer(await service.signals.shown(service.watched.attached))


async def _values(service: Service, request: Request) -> Response:
    service.session(request)
    return answer(await service.signals.values(service.watched.attached))


ROUTES = (
    Route("GET", "/api/signals", _signals,
        "Return inputs and outputs by name, with what the cell's file says of them.", None, SignalsShown,
            "viewer"),
    Route("GET", "/api/signals/values", _values,
        "Return the values of inputs and outputs, and the WAIT at which the robot stands.", None,
            SignalValues, "viewer"),
)  # fmt: skip
"""All routes of this file."""
