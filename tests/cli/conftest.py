"""Fixtures that the tests of the commands share."""

import pytest

from tests.cli.run_processes import Spare, Workshop


@pytest.fixture
def workshop(tmp_path):
    workshop = Workshop(tmp_path)
    yield workshop
    workshop.close()


@pytest.fixture(scope="package")
def spare(tmp_path_factory):
    spare = Spare(tmp_path_factory.mktemp("spare"))
    yield spare
    spare.close()


@pytest.fixture
def simulator(spare):
    """Start `yarc sim --robot INDUSTRIAL6` in a process of its own, at HOME."""
    return spare.simulator()
