"""The ROS 1 master: its registrations of this node, made again when a master is started anew.

rospy registers once. A master that was ended and started again knows nothing of the node: topics that are connected go on, but nobody new finds them. So the master is asked
now and then if it knows this node, and is told all of it again if it doesn't.

Written for Python 3.8 and later.
"""

from __future__ import annotations

import http.client
import xmlrpc.client
from typing import Any, List, NamedTuple, Tuple

PATIENCE = 2.0
"""A master that takes longer to answer hangs [s]."""

LOST = (OSError, http.client.HTTPException, xmlrpc.client.Error)
"""What a call raises if there is no master, or something else at its address."""


class Registered(NamedTuple):
    """What a node has told its master.

    Attributes:
        published: topics with their types.
        subscribed: topics with their types.
        services: services with the addresses under which they are called.
    """

    published: List[Tuple[str, str]]
    subscribed: List[Tuple[str, str]]
    services: List[Tuple[str, str]]


class Master:
    """The master, as one node sees it. Each call raises one of `LOST` if it isn't there.

    Args:
        address: its URI.
        node: name of the node, resolved.
    """

    def __init__(self, address: str, node: str) -> None:
        self.address = address
        self._node = node

    def answers(self) -> bool:
        """Return True if a master is there."""
        try:
            return bool(_call(self.address, "getPid", self._node)[0] == 1)
        except LOST:
            return False

    def knows_node(self) -> bool:
        """Return True if a node of this name is registered: this one, or one that has taken its place, which must not be turned out again."""
        return bool(_call(self.address, "lookupNode", self._node, self._node)[0] == 1)

    def register(self, node_address: str, registered: Registered) -> None:
        """Tell the master all that a node has, and the node who publishes what it subscribes to."""
        for topic, kind in registered.published:
            _call(self.address, "registerPublisher", self._node, topic, kind, node_address)
        for service, place in registered.services:
            _call(self.address, "registerService", self._node, service, place, node_address)
        for topic, kind in registered.subscribed:
            publishers = _call(self.address, "registerSubscriber", self._node, topic, kind, node_address)[2]
            _call(node_address, "publisherUpdate", "/master", topic, publishers)


def _call(address: str, name: str, *values: Any) -> Any:
    """Call a method; return (code, message, value)."""
    with xmlrpc.client.ServerProxy(address, transport=_Patient()) as server:
        answer = getattr(server, name)(*values)
    if not isinstance(answer, list) or len(answer) != 3:
        raise xmlrpc.client.ResponseError(f"{name} is answered by something that is no ROS node")
    return answer


class _Patient(xmlrpc.client.Transport):
    """A transport with a time limit."""

    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        made = super().make_connection(host)
        made.timeout = PATIENCE
        return made
