"""Tests that the docstrings below a message's fields are in the message's schema, in whatever class a field
is declared.
"""

from yarclang.coordinator.messages import orders, replies
from yarclang.coordinator.messages.field_texts import field_texts


def test_texts_are_those_of_the_source():
    assert field_texts(replies.Status)["controller"] == "Address of the controller, HOST:PORT."
    schema = replies.Status.model_json_schema()["properties"]
    assert schema["controller"]["description"] == "Address of the controller, HOST:PORT."
    assert "description" not in schema["robot"]
    # The description of the field itself has precedence.
    assert (
        orders.Load.model_json_schema()["properties"]["first"]["description"]
        == "the index of a command, or null"
    )
    assert field_texts(orders.Load)["first"] == "Index of the command at which the run begins."


def test_texts_of_bases_are_there():
    class Below(replies.Status):
        pass

    assert field_texts(Below) == field_texts(replies.Status)
