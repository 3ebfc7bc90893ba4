"""The server keeps nothing of messages that it has handled."""

import asyncio

from yarclang.lsp.server import Protocol


async def _handled(count):
    protocol, answers = Protocol.__new__(Protocol), []
    protocol._request_futures = {}

    async def later(number):
        await asyncio.sleep(0)
        return number

    def by_another(number):
        found = yield later, (number,), None
        return found

    for number in range(count):
        handler = (later, by_another)[number % 2]
        protocol._execute_handler(str(number), handler, answers.append, (number,))
    while len(answers) < count:
        await asyncio.sleep(0)
    await asyncio.sleep(0)
    return sorted(one.result() for one in answers), protocol._request_futures


def test_messages_are_forgotten_once_they_are_handled():
    assert asyncio.run(_handled(20)) == (list(range(20)), {})
