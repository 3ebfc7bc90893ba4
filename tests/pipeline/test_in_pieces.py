"""Tests of writing a certificate piece by piece: the text is that of a single json.dumps."""

import json

import pytest
from programs import compiled

from yarclang.pipeline.jobs import in_pieces


@pytest.mark.parametrize(
    "content", [{}, {"a": [], "b": [1, {"c": None}, "\u00b0"]}, {'"': {"x": [1.5]}, "y": True}]
)
def test_what_is_written_in_pieces_is_the_same(content):
    assert in_pieces(content) == json.dumps(content)


def test_a_certificate_is():
    value, _ = compiled("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n", "INDUSTRIAL6")
    content = value.certificate.to_json()
    assert in_pieces(content) == json.dumps(content)
