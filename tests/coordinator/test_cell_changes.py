"""Tests of a cell whose file changes while its robot is served. Later plans respect the change, and earlier
proofs aren't carried out any more.
"""

import numpy as np
import pytest
from coordinator.virtual import coordinating, run

from yarclang.coordinator.attached import Here
from yarclang.coordinator.live.steering import JointVelocity
from yarclang.coordinator.messages import orders
from yarclang.runtime.actions import Trouble

FREE = 'units = "mm,deg"\n'
WALL = FREE + (
    "[[zones]]\n"
    'name = "WALL"\n'
    'rule = "forbidden"\n'
    'shape = "half-space"\n'
    'frame = "B"\n'
    "xyz = [0, 0, 9000]\n"
    "normal = [0, 0, -1]\n"
    'watch = ["tcp"]\n'
)
UP = "MOVEJ 0 0 0 0 30 0 [4] (deg,s)"


def at(folder, work):
    (folder / "yarc.toml").write_text('cell = "cell.toml"\n')
    (folder / "cell.toml").write_text(FREE)
    (folder / "up.yarc").write_text(f"P0010 {UP}\nP0020 MOVEJ HOME [4] (deg,s)\n")

    async def whole():
        async with coordinating(folder=folder) as (_, coordinator, client):
            client.session.leave()
            mine = Here(coordinator, "anna")
            await mine.ask(orders.Own())
            await work(coordinator, mine)

    run(whole())


def test_offers_jogs_and_programs_keep_to_the_new_file(tmp_path):
    async def work(coordinator, mine):
        offered = await mine.ask(orders.Offer(text=UP))
        loaded = await mine.ask(orders.Load(file=str(tmp_path / "up.yarc")))
        assert offered.offer is not None
        assert loaded.program is not None
        (tmp_path / "cell.toml").write_text(WALL)
        with pytest.raises(Trouble, match="the cell has changed"):
            await mine.ask(orders.Go(offer=offered.offer.number))
        with pytest.raises(Trouble, match=r"the cell has changed since up\.yarc was loaded"):
            await mine.ask(orders.Run(program=loaded.program.number))
        again = await mine.ask(orders.Offer(text=UP))
        assert again.offer is None
        assert "WALL" in again.findings[0].message
        assert (await mine.ask(orders.Load(file=str(tmp_path / "up.yarc")))).program is None
        drive = await mine.client.live.drive(JointVelocity(np.zeros(6)))
        assert drive.value is None
        assert "WALL" in drive.diagnostics[0].message
        (tmp_path / "cell.toml").write_text(FREE)
        loaded = await mine.ask(orders.Load(file=str(tmp_path / "up.yarc")))
        assert (await mine.ask(orders.Run(program=loaded.program.number))).well

    at(tmp_path, work)


def test_a_motion_isnt_taken_back_through_another_cell(tmp_path):
    async def work(coordinator, mine):
        offered = await mine.ask(orders.Offer(text=UP))
        assert (await mine.ask(orders.Go(offer=offered.offer.number))).well
        assert (await mine.ask(orders.OfferBack())).offer is not None
        (tmp_path / "cell.toml").write_text(FREE + "# another one\n")
        refused = await mine.ask(orders.OfferBack())
        assert refused.offer is None
        assert "the cell has changed" in refused.findings[0].message

    at(tmp_path, work)


def test_a_broken_or_missing_cell_forbids_all_motions(tmp_path):
    async def work(coordinator, mine):
        for text in ("zones = 3", None):
            if text is None:
                (tmp_path / "cell.toml").unlink()
            else:
                (tmp_path / "cell.toml").write_text(text)
            assert (await mine.ask(orders.Offer(text=UP))).offer is None
        (tmp_path / "cell.toml").write_text(FREE)
        assert (await mine.ask(orders.Offer(text=UP))).offer is not None

    at(tmp_path, work)


def test_a_project_that_gets_its_first_cell_keeps_to_it(tmp_path):
    async def work(coordinator, mine):
        (tmp_path / "yarc.toml").unlink()
        loaded = await mine.ask(orders.Load(file=str(tmp_path / "up.yarc")))
        (tmp_path / "cell.toml").write_text(WALL)
        (tmp_path / "yarc.toml").write_text('cell = "cell.toml"\n')
        with pytest.raises(Trouble, match="the cell has changed"):
            await mine.ask(orders.Run(program=loaded.program.number))
        assert (await mine.ask(orders.Offer(text=UP))).offer is None
        assert (await mine.ask(orders.AskSurroundings())).cell == str(tmp_path / "cell.toml")

    at(tmp_path, work)


def test_another_cell_is_named_only_by_a_restart(tmp_path):
    async def work(coordinator, mine):
        (tmp_path / "other.toml").write_text(FREE)
        for settings in ('cell = "other.toml"\n', "", "cell = 3\n"):
            (tmp_path / "yarc.toml").write_text(settings)
            assert (await mine.ask(orders.AskSurroundings())).cell == str(tmp_path / "cell.toml")
            assert (await mine.ask(orders.Offer(text=UP))).offer is not None
        (tmp_path / "cell.toml").write_text(WALL)
        assert (await mine.ask(orders.Offer(text=UP))).offer is None

    at(tmp_path, work)
