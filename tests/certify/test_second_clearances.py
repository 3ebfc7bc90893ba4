"""Tests of the second proof of clearances: it agrees with a correct first proof, and refutes a wrong one."""

from dataclasses import replace

import numpy as np
import pytest
from programs import codes, compiled

from tests.collision.dense import Dense
from tests.collision.test_proof import ROBOTS, drawn, random_motion
from yarclang.certify.bodies.second import EQUAL, refuted
from yarclang.collision import planes, proof
from yarclang.collision.proof import KNOWN, clearances
from yarclang.collision.scene import scene_of
from yarclang.pipeline.cells import cell_loader
from yarclang.robot.description import load_robot


def proved(seed):
    random = np.random.default_rng(seed)
    robot = load_robot(ROBOTS[seed % 2]).value
    cell = drawn(random)
    scene, course = scene_of(robot, cell).value, random_motion(robot, random)
    count = len(course.x)
    spans = np.array([[0, count // 2], [count // 2, count]])
    return robot, cell, scene, course, spans, clearances(scene, course, spans)


@pytest.mark.parametrize("seed", range(1000, 1040))
def test_both_proofs_agree(seed):
    _, _, scene, course, spans, found = proved(seed)
    assert refuted(scene, course, spans, found, None) == []


def test_a_clearance_that_is_too_large_is_refuted():
    """A reported clearance that is larger than the true distance is refuted, at a place where the bodies
    really are as near as the refutation says, by Pinocchio's placements.
    """
    seen = 0
    for seed in range(1000, 1024):
        robot, cell, scene, course, spans, found = proved(seed)
        met = {one.motion for one in found.meetings}
        dense = Dense(robot, cell)
        for motion in {0, 1} - met:
            for kind in (0, 1):
                near, least = int(found.nearest[motion, kind]), float(found.least[motion, kind])
                if near < 0 or not 0.0 < least < KNOWN / 2:
                    continue
                # A bound may be 10 % and 1 mm below the truth.
                wrong = found.least.copy()
                wrong[motion, kind] = least / 0.85 + 0.002
                places = refuted(scene, course, spans, replace(found, least=wrong), None)
                (place,) = [one for one in places if one.pair == near]
                apart = dense.distances(course.at(np.array([place.time])))[0]
                names = frozenset(scene.names(near))
                (distance,) = [apart[pair] for pair in range(len(dense.pairs)) if dense.names(pair) == names][
                    :1
                ]
                assert place.motion == motion
                assert distance <= place.distance + 1e-6 < wrong[motion, kind] - EQUAL + 1e-6
                seen += 1
    assert seen >= 10


def test_a_pair_that_nobody_watched_is_refuted():
    """If the first proof has overlooked a collision, the second one finds it, whatever the order of the
    bodies in a pair is.
    """
    collided = 0
    for seed in range(1000, 1024):
        _, _, scene, course, spans, found = proved(seed)
        blind = replace(found, meetings=(), nearest=np.full_like(found.nearest, -1))
        wanted = {
            (one.motion, one.pair)
            for one in found.meetings
            if one.distance < scene.pairs.margin[one.pair] - 1e-3
        }
        turned = replace(
            scene, pairs=replace(scene.pairs, first=scene.pairs.second, second=scene.pairs.first)
        )
        for one in (scene, turned):
            places = {(place.motion, place.pair) for place in refuted(one, course, spans, blind, None)}
            assert wanted <= places
        collided += len(wanted)
    assert collided >= 10


CELL = """units = "mm,deg,s"
[[obstacles]]
name = "POST"
shape = "box"
frame = "B"
xyz = [-800, 680, 1764]
size = [200, 200, 200]
rpy = [0, 0, 10]
margin = 5
"""


@pytest.mark.parametrize("error", ["the other body", "no margin", "far away"])
def test_an_error_of_the_first_proof_is_never_certified(tmp_path, monkeypatch, error):
    (tmp_path / "cell.toml").write_text(CELL)
    text = 'CELL "cell.toml"\nP0010 MOVEJ {} 0 0 0 0 0 [6] (deg,s)\nP0020 MOVEJ HOME [6] (deg,s)\n'

    def made(turn):
        loader = cell_loader(tmp_path, load_robot("INDUSTRIAL6").value)
        return compiled(text.format(turn), "INDUSTRIAL6", load_cell=loader)

    assert made(39.6)[0] is not None
    value, found = made(39.9)
    assert (value, codes([one for one in found if one.is_error])[0]) == (None, "Y0903")
    if error == "the other body":
        right = planes.plane_gap

        def wrong(scene, pair, seen, normal):
            return right(scene, pair, seen, normal) + 2 * planes.support(
                scene, scene.pairs.first[pair], normal
            )

        monkeypatch.setattr(planes, "plane_gap", wrong)
    elif error == "no margin":
        monkeypatch.setattr(proof._Search, "_learn", lambda self, rows, time: None)
        monkeypatch.setattr(proof._Search, "_still_open", lambda self, rows: np.arange(0))
    else:
        monkeypatch.setattr(proof, "sphere_gaps", lambda placed, at, pair: np.full(len(pair), 9.0))
    value, found = made(39.7)
    assert value is None
    assert set(codes([one for one in found if one.is_error])) == {"Y1180"}
