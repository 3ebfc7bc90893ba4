"""Tests of speeds that a chain can't nearly reach: only few laws are tried before a slower speed is found."""

from programs import compiled

from yarclang.motion.chains.between import Between
from yarclang.pipeline.modules import library_folder, loader

WEAVE = """USE WEAVE
DEFAULT {TCP} (mm,deg,s) {B}
FRAME {SEAM} 0 1174.4 1176 0 0 0 {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [MIN]
P0020 CALL WEAVE.SINE {TCP} {SEAM} 12 1 2 4
"""


def test_few_laws_are_tried_where_the_way_itself_asks_too_much(monkeypatch):
    """The path has four waves a second of 2 mm to each side, of which the limits allow a fifteenth. Formerly,
    this took two minutes and 17,000 laws.
    """
    laws = []
    tried = Between._tried

    def counted(self, some):
        laws.append(len(some))
        return tried(self, some)

    monkeypatch.setattr(Between, "_tried", counted)
    _, found = compiled(WEAVE, "INDUSTRIAL6", load=loader(library_folder()))
    told = [one for one in found if one.code == "Y0610"]
    assert told
    assert "the limits don't allow this speed from" in told[0].message
    assert 0 < sum(laws) < 2000
