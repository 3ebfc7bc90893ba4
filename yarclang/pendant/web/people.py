"""HTTP routes for logins, users, sessions and the audit trail."""

from __future__ import annotations

import time

from starlette.requests import Request
from starlette.responses import Response

from yarclang.coordinator.messages.replies import Done
from yarclang.pendant.accounts.people import Deed
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.accounts.sessions import LONGEST, Session
from yarclang.pendant.messages.people import (
    Audit,
    AuditEntry,
    ChangeOwn,
    ChangeUser,
    First,
    Login,
    Me,
    NewUser,
    NotLoggedIn,
    Pin,
    SessionList,
    SessionShown,
    Users,
    UserShown,
)
from yarclang.pendant.web.answers import answer, body, number_in
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import COOKIE, DEVICE, Service, address_of, cookie, is_secure
from yarclang.runtime.actions import Trouble

_YEAR = 365 * 24 * 3600
_MOST_ENTRIES = 500


async def _first(service: Service, request: Request) -> Response:
    asked = await body(request, First)
    await service.accounts.begin(asked.token, asked.user, asked.password, asked.pin, address_of(request))
    return await _logged_in(service, request, asked.user, asked.password)


async def _login(service: Service, request: Request) -> Response:
    asked = await body(request, Login)
    return await _logged_in(service, request, asked.user, asked.password)


async def _logged_in(service: Service, request: Request, user: str, password: str) -> Response:
    device = request.cookies.get(cookie(request, DEVICE), "")
    session, token, device = await service.accounts.login(
        user, password, address_of(request), request.headers.get("user-agent", ""), device
    )
    response = answer(_me(service, session))
    for name, value, lasts in ((COOKIE, token, int(LONGEST)), (DEVICE, device, _YEAR)):
        response.set_cookie(
            cookie(request, name),
            value,
            max_age=lasts,
            path="/",
            httponly=True,
            samesite="strict",
            secure=is_secure(request),
        )
    return response


async def _logout(service: Service, request: Request) -> Response:
    session = service.session(request)
    await service.accounts.logout(session)
    made = answer(Done())
    made.delete_cookie(
        cookie(request, COOKIE), path="/", httponly=True, samesite="strict", secure=is_secure(request)
    )
    return made


async def _names_of_users(service: Service, request: Request) -> Response:
    found = service.accounts.session_of(request.cookies.get(cookie(request, COOKIE), ""))
    if found is None:
        first = bool(service.accounts.first)
        return answer(NotLoggedIn(error="nobody is logged in here", first=first), 401)
    return answer(_me(service, found))


def _me(service: Service, session: Session) -> Me:
    return Me(
        user=session.user,
        role=session.role.value,
        session=session.id,
        pin_s=round(max(0.0, session.pin_until - time.monotonic()), 1),
        client=service.seats.name(session),
    )


async def _pin(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE)
    await service.accounts.confirm(session, (await body(request, Pin)).pin)
    return answer(_me(service, session))


async def _change_own(service: Service, request: Request) -> Response:
    session = service.session(request)
    asked = await body(request, ChangeOwn)
    await service.accounts.change_own(session, asked.old_password, password=asked.password, pin=asked.pin)
    what = " and ".join(one for one in ("password", "pin") if getattr(asked, one) is not None)
    await service.accounts.did(Deed(session.user, address_of(request), "own account", what))
    return answer(Done())


async def _users(service: Service, request: Request) -> Response:
    service.session(request, Role.SERVICE)
    sessions = [one.user.casefold() for one in service.accounts.sessions.all()]
    return answer(
        Users(
            users=tuple(
                UserShown(
                    user=one.name,
                    role=one.role.value,
                    has_pin=one.pin is not None,
                    sessions=sessions.count(one.name.casefold()),
                )
                for one in await service.accounts.all_users()
            )
        )
    )


async def _add_user(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE, pin=True)
    asked = await body(request, NewUser)
    await service.accounts.add(asked.user, Role(asked.role), asked.password, asked.pin)
    await service.accounts.did(
        Deed(session.user, address_of(request), "add user", f"{asked.user}: {asked.role}")
    )
    return answer(Done())


async def _change_user(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE, pin=True)
    name = request.path_params["user"]
    asked = await body(request, ChangeUser)
    role = None if asked.role is None else Role(asked.role)
    await service.accounts.change(name, role=role, password=asked.password, pin=asked.pin)
    what = [f"role {asked.role}"] if asked.role else []
    what += [one for one in ("password", "pin") if getattr(asked, one) is not None]
    await service.accounts.did(
        Deed(session.user, address_of(request), "change user", f"{name}: {', '.join(what) or 'nothing'}")
    )
    return answer(Done())


async def _remove_user(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE, pin=True)
    name = request.path_params["user"]
    await service.accounts.remove(name)
    await service.accounts.did(Deed(session.user, address_of(request), "remove user", name))
    return answer(Done())


async def _sessions(service: Service, request: Request) -> Response:
    session = service.session(request)
    now = time.monotonic()
    everybody = session.role.covers(Role.SERVICE)
    return answer(
        SessionList(
            sessions=tuple(
                SessionShown(
                    session=one.id,
                    user=one.user,
                    role=one.role.value,
                    address=one.address,
                    agent=one.agent,
                    open_s=round(now - one.opened, 1),
                    quiet_s=round(now - one.seen, 1),
                    here=one is session,
                    pages=service.watched.pages_of(one.id),
                )
                for one in service.accounts.sessions.all()
                if everybody or one.user == session.user
            )
        )
    )


async def _end_session(service: Service, request: Request) -> Response:
    session = service.session(request)
    other = service.accounts.sessions.called(request.path_params["session"])
    if other is None or (other.user != session.user and not session.role.covers(Role.SERVICE)):
        raise Trouble("there is no such session", "look at the list of sessions", "")
    if other.user != session.user:
        service.accounts.check(session, Role.SERVICE, pin=True)
    service.accounts.sessions.end(other)
    await service.accounts.did(Deed(session.user, address_of(request), "end session", other.user))
    return answer(Done())


async def _audit(service: Service, request: Request) -> Response:
    service.session(request, Role.SERVICE)
    before, count = (number_in(request, name) for name in ("before", "count"))
    deeds = await service.accounts.deeds(before, min(max(count or 100, 1), _MOST_ENTRIES))
    return answer(
        Audit(
            entries=tuple(
                AuditEntry(
                    number=number,
                    time=when,
                    user=deed.user,
                    address=deed.address,
                    action=deed.action,
                    detail=deed.detail,
                    outcome=deed.outcome,
                )
                for number, when, deed in deeds
            )
        )
    )


ROUTES = (
    Route("GET", "/api/me", _names_of_users, "Return who is logged in here.", None, Me, ""),
    Route("POST", "/api/first", _first,
        "Make the first user, with the token of the one-time link, and log in.", First, Me, ""),
    Route("POST", "/api/login", _login, "Log in: sets the cookie of the session.", Login, Me, ""),
    Route("POST", "/api/logout", _logout, "End this session.", None, Done, "viewer"),
    Route("POST", "/api/pin", _pin, "Allow service work for five minutes.", Pin, Me, "service"),
    Route("POST", "/api/me", _change_own, "Change one's own password or PIN.", ChangeOwn, Done, "viewer"),
    Route("GET", "/api/users", _users, "Return all users.", None, Users, "service"),
    Route("POST", "/api/users", _add_user, "Add a user.", NewUser, Done, "service, PIN"),
    Route("POST", "/api/users/{user}", _change_user, "Change a user.", ChangeUser, Done, "service, PIN"),
    Route("DELETE", "/api/users/{user}", _remove_user, "Remove a user.", None, Done, "service, PIN"),
    Route("GET", "/api/sessions", _sessions, "Return the sessions of everybody (service), or one's own.",
        None, SessionList, "viewer"),
    Route("DELETE", "/api/sessions/{session}", _end_session,
        "End a session: one's own, or (service, PIN) anybody's.", None, Done, "viewer"),
    Route("GET", "/api/audit", _audit,
        "Return entries of the audit trail, the newest first (`before`: smaller numbers only; `count`: 500 "
        "at most).", None, Audit, "service"),
)  # fmt: skip
"""All routes of this file."""
