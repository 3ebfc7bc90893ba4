"""HTTP routes for alarms, and for the explanations of their codes."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from itertools import islice

from starlette.requests import Request
from starlette.responses import Response

from yarclang.findings import CATALOGUE, FAMILIES
from yarclang.pendant.accounts.people import Deed
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.alarms.alarm import Alarm
from yarclang.pendant.alarms.export import as_csv, utc
from yarclang.pendant.messages.alarms import (
    Acknowledge,
    Acknowledged,
    AlarmList,
    AlarmShown,
    FindingShown,
    JointAt,
)
from yarclang.pendant.messages.reading import Malformed
from yarclang.pendant.web.answers import answer, body, number_in, refusal
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service, address_of
from yarclang.runtime.actions import Trouble

_MOST_LISTED = 500
_MOST_TOLD = 40
"""Largest number of alarms that one entry of the audit trail lists."""


async def _list(service: Service, request: Request) -> Response:
    service.session(request)
    book = service.alarms.book
    before, count = number_in(request, "before"), min(number_in(request, "count") or 100, _MOST_LISTED)
    wanted_list = request.query_params.get("which", "open")
    if wanted_list == "open":
        alarms: Iterable[Alarm] = (one for one in book.open() if before is None or one.number < before)
    elif wanted_list == "past":
        alarms = book.past(before)
    else:
        raise Malformed(f"which is {wanted_list[:40]!r}; it may be open or past", "see the API's page", "")
    listed = tuple(islice(alarms, count + 1))
    return answer(
        AlarmList(
            alarms=tuple(_alarm_shown(one) for one in listed[:count]),
            open=book.open_count,
            all=len(book),
            more=len(listed) > count,
            version=book.version,
            trouble=service.alarms.trouble,
        )
    )


async def _alarm_by_number(service: Service, request: Request) -> Response:
    service.session(request)
    text = request.path_params["number"]
    found = service.alarms.book.get(int(text)) if text.isdecimal() and len(text) < 16 else None
    if found is None:
        return _missing(f"there is no alarm {text[:20]!r}", "look at the list of alarms")
    return answer(_alarm_shown(found))


async def _export(service: Service, request: Request) -> Response:
    service.session(request)
    text = await asyncio.to_thread(as_csv, service.alarms.book.all())
    headers = {"content-disposition": 'attachment; filename="alarms.csv"', "cache-control": "no-store"}
    return Response(text, headers=headers, media_type="text/csv; charset=utf-8")


async def _acknowledge(service: Service, request: Request) -> Response:
    session = service.session(request, Role.OPERATOR)
    request_body = await body(request, Acknowledge)
    service.accounts.used(session)
    book = service.alarms.book
    wanted_numbers = request_body.numbers
    if request_body.up_to is not None:
        wanted_numbers = (
            *wanted_numbers,
            *(one.number for one in book.open() if one.number <= request_body.up_to),
        )
    if not wanted_numbers:
        raise Malformed("no alarm is named", "give numbers, or up_to", "")
    numbers = book.unacknowledged(wanted_numbers)
    if numbers:
        more = f" and {len(numbers) - _MOST_TOLD} more" if len(numbers) > _MOST_TOLD else ""
        detail = f"{' '.join(map(str, numbers[:_MOST_TOLD]))}{more}"
        await service.accounts.did(Deed(session.user, address_of(request), "acknowledge alarms", detail))
    return answer(Acknowledged(count=await service.alarms.acknowledge(numbers, session.user)))


async def _finding(service: Service, request: Request) -> Response:
    service.session(request)
    code = request.path_params["code"].upper()
    finding = CATALOGUE.get(code)
    if finding is None:
        return _missing(f"there is no finding {code[:20]!r}", "codes are Y and four digits, as in Y0101")
    return answer(
        FindingShown(
            code=finding.code,
            name=finding.name,
            severity=finding.severity,
            family=FAMILIES[finding.family],
            title=finding.title,
            why=finding.why,
            example=finding.example,
            better=finding.better,
        )
    )


def _missing(subject: str, remedy: str) -> Response:
    made = refusal(Trouble(subject, remedy, "missing"))
    made.status_code = 404
    return made


def _alarm_shown(alarm: Alarm) -> AlarmShown:
    raised, stood = alarm.raised, alarm.stood
    finding = CATALOGUE.get(raised.code)
    return AlarmShown(
        number=alarm.number,
        time=utc(alarm.time),
        last=utc(alarm.last),
        count=alarm.count,
        holds=alarm.holds,
        ended=None if alarm.ended is None else utc(alarm.ended),
        acknowledged=None if alarm.acknowledged is None else utc(alarm.acknowledged),
        by=alarm.by,
        source=raised.source,
        code=raised.code,
        title="" if finding is None else finding.title,
        what=raised.what,
        remedy=raised.remedy,
        program=stood.program,
        file=stood.file,
        line=stood.line,
        command=stood.command,
        joints=tuple(JointAt(name=name, value=value, unit=unit) for name, value, unit in stood.joints),
        flange=stood.flange,
        owner=stood.owner,
    )


ROUTES = (
    Route("GET", "/api/alarms", _list,
        "Return alarms, the newest first: open ones, or with ?which=past the others (`before`: smaller "
        "numbers only; `count`: 500 at most).", None, AlarmList, "viewer"),
    Route("GET", "/api/alarms/export", _export, "Return all alarms as CSV, to be saved.", None, None,
        "viewer"),
    Route("GET", "/api/alarms/{number}", _alarm_by_number, "Return an alarm.", None, AlarmShown, "viewer"),
    Route("POST", "/api/alarms/acknowledge", _acknowledge, "Acknowledge alarms, for all screens.",
        Acknowledge, Acknowledged, "operator"),
    Route("GET", "/api/findings/{code}", _finding, "Return the explanation of a finding by its code.",
        None, FindingShown, "viewer"),
)  # fmt: skip
"""All routes of this file."""
