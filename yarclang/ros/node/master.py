"""Registration of this node at the ROS 1 master, which is repeated after a restart of the master.

rospy registers only once. A restarted master doesn't know the node: connected topics continue, but new
subscribers don't find them. Therefore the master is asked regularly if it knows this node. If it doesn't, all
topics and services of the node are registered again.

Written for Python 3.8 and later.
"""

from __future__ import annotations

import http.client
import xmlrpc.client
from typing import Any, List, NamedTuple, Tuple

PATIENCE = 2.0
"""Time after which a master that doesn't reply counts as hanging [s]."""

LOST = (OSError, http.client.HTTPException, xmlrpc.client.Error)
"""Exceptions of a call if there is no master, or another program at its address."""


class Registered(NamedTuple):
    """Topics and services that a node has registered at its master.

    Attributes:
        published: published topics with their types.
        subscribed: subscribed topics with their types.
        services: services with their addresses.
    """

    published: List[Tuple[str, str]]
    subscribed: List[Tuple[str, str]]
    services: List[Tuple[str, str]]


class Master:
    """Calls of one node to the ROS 1 master. Each call raises one of `LOST` if the master can't be reached.

    Args:
        address: URI of the master.
        node: name of the node, resolved.
    """

    def __init__(self, address: str, node: str) -> None:
        self.address = address
        self._node = node

    def answers(self) -> bool:
        """Return True if the master replies."""
        try:
            return bool(_call(self.address, "getPid", self._node)[0] == 1)
        except LOST:
            return False

    def knows_node(self) -> bool:
        """Return True if the master knows a node of this name. It may be another node that has replaced this
        one; then this node must not register again.
        """
        return bool(_call(self.address, "lookupNode", self._node, self._node)[0] == 1)

    def register(self, node_address: str, registered: Registered) -> None:
        """Register all topics and services of a node at the master. Tell the node the publishers of its
        subscribed topics.
        """
        for topic, kind in registered.published:
            _call(self.address, "registerPublisher", self._node, topic, kind, node_address)
        for service, place in registered.services:
            _call(self.address, "registerService", self._node, service, place, node_address)
        for topic, kind in registered.subscribed:
            publishers = _call(self.address, "registerSubscriber", self._node, topic, kind, node_address)[2]
            _call(node_address, "publisherUpdate", "/master", topic, publishers)


def _call(address: str, name: str, *values: Any) -> Any:
    """Call a method of the master. Return the master's reply (code, message, value)."""
    with xmlrpc.client.ServerProxy(address, transport=_Patient()) as server:
        answer = getattr(server, name)(*values)
    if not isinstance(answer, list) or len(answer) != 3:
        raise xmlrpc.client.ResponseError(f"{name} is registered by something that isn't a ROS node")
    return answer


class _Patient(xmlrpc.client.Transport):
    """A transport with a time limit."""

    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        made = super().make_connection(host)
        made.timeout = PATIENCE
        return made
