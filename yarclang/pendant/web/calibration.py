"""HTTP routes for calibrations: recording the robot's positions (touches), the result that follows from
them, and writing the result to a file.
"""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import Response

from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.calibrating.looking import look
from yarclang.pendant.calibrating.shown import shown
from yarclang.pendant.calibrating.writing import ROLES
from yarclang.pendant.messages import calibration as said
from yarclang.pendant.web.answers import answer, body
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service, address_of


def _shown_calibration(service: Service, session: Session) -> Response:
    own = service.calibrations.of(session)
    return answer(shown(own or service.calibrations.other(), mine=own is not None))


async def _answer(service: Service, request: Request) -> Response:
    return _shown_calibration(service, service.session(request))


def _programmer(service: Service, request: Request) -> Session:
    session = service.session(request, Role.PROGRAMMER)
    service.accounts.used(session)
    return session


async def _begin(service: Service, request: Request) -> Response:
    session = _programmer(service, request)
    await service.calibrations.begin(session, await body(request, said.BeginCalibration))
    return _shown_calibration(service, session)


async def _touch(service: Service, request: Request) -> Response:
    session = _programmer(service, request)
    await service.calibrations.touch(session, await body(request, said.TakeTouch))
    return _shown_calibration(service, session)


async def _remove(service: Service, request: Request) -> Response:
    session = _programmer(service, request)
    service.calibrations.remove(session, await body(request, said.RemoveTouch))
    return _shown_calibration(service, session)


async def _forget(service: Service, request: Request) -> Response:
    session = _programmer(service, request)
    service.calibrations.forget(session.id)
    return _shown_calibration(service, session)


async def _look_at(service: Service, request: Request) -> Response:
    session = _programmer(service, request)
    asked = await body(request, said.LookCalibration)
    return answer(look(service.calibrations.going_on(session, asked.version), asked))


async def _propose(service: Service, request: Request) -> Response:
    session = _programmer(service, request)
    return answer(
        await service.calibration_writing.propose(session, await body(request, said.ProposeCalibration))
    )


async def _write(service: Service, request: Request) -> Response:
    session = _programmer(service, request)
    asked = await body(request, said.WriteCalibration)
    role = ROLES[asked.to]
    service.accounts.check(session, role, pin=role is Role.SERVICE)
    return answer(await service.calibration_writing.write(session, address_of(request), asked))


ROUTES = (
    Route("GET", "/api/calibration", _answer,
        "Return the calibration of this session, else the newest of another one.", None,
            said.CalibrationShown, "viewer"),
    Route("POST", "/api/calibration", _begin, "Begin a calibration.", said.BeginCalibration,
        said.CalibrationShown, "programmer"),
    Route("DELETE", "/api/calibration", _forget, "Forget this session's calibration.", None,
        said.CalibrationShown, "programmer"),
    Route("POST", "/api/calibration/touch", _touch, "Record the robot's position as a touch.", said.TakeTouch,
        said.CalibrationShown, "programmer"),
    Route("POST", "/api/calibration/remove", _remove, "Take a touch away.", said.RemoveTouch,
        said.CalibrationShown, "programmer"),
    Route("POST", "/api/calibration/look", _look_at,
        "Return the text of an offer that leads to a place at which the result can be inspected; nothing "
        "moves.", said.LookCalibration, said.LookText, "programmer"),
    Route("POST", "/api/calibration/propose", _propose,
        "Return the change of a file that the result makes; nothing is written.", said.ProposeCalibration,
            said.CalibrationProposal, "programmer"),
    Route("POST", "/api/calibration/write", _write,
        "Write the result: into the robot's or the cell's file (role service and PIN), or into a program.",
            said.WriteCalibration, said.CalibrationWritten, "programmer"),
)  # fmt: skip
"""All routes of this file."""
