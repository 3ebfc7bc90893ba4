"""Each command has a manual page with all of its options, which man reads without an error."""

import shutil
import subprocess

import click
import pytest
from click.testing import CliRunner

from yarclang import __version__
from yarclang.cli.manual import _plain, manual_pages
from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc

PAGES = dict([*manual_pages(yarc, "yarc", __version__), *manual_pages(yarcc, "yarcc", __version__)])


def commands(command, context):
    yield context
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            inner = command.get_command(context, name)
            if not inner.hidden:
                yield from commands(inner, click.Context(inner, info_name=name, parent=context))


ALL = [
    *commands(yarc, click.Context(yarc, info_name="yarc")),
    *commands(yarcc, click.Context(yarcc, info_name="yarcc")),
]


def test_each_command_has_a_page_and_no_other():
    assert {f"{one.command_path.replace(' ', '-')}.1" for one in ALL} == set(PAGES)
    assert {"yarc.1", "yarcc.1", "yarc-robot-new.1", "yarc-import.1"} <= set(PAGES)


@pytest.mark.parametrize("context", ALL, ids=lambda one: one.command_path)
def test_a_page_has_all_options(context):
    page = PAGES[f"{context.command_path.replace(' ', '-')}.1"]
    shown = [
        one for one in context.command.get_params(context) if isinstance(one, click.Option) and not one.hidden
    ]
    assert shown
    for option in shown:
        for written in (*option.opts, *option.secondary_opts):
            assert _plain(written) in page
    assert page.count("\n.SH NAME\n") == page.count("\n.SH DESCRIPTION\n") == 1


@pytest.mark.skipif(shutil.which("groff") is None, reason="needs groff")
def test_groff_reads_them_without_a_warning(tmp_path):
    for name, text in PAGES.items():
        (tmp_path / name).write_text(text)
    done = subprocess.run(
        ["groff", "-man", "-Tutf8", "-ww", "-z", *sorted(map(str, tmp_path.iterdir()))],
        check=False,
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")
    check = subprocess.run(
        ["groff", "-man", "-Tutf8", "-P-cbou", str(tmp_path / "yarc-check.1")],
        check=False,
        capture_output=True,
        text=True,
    )
    assert "--max-findings N" in check.stdout
    assert "Check programs: everything that yarcc checks" in check.stdout


def test_text_is_never_a_request():
    assert _plain(".so /etc/passwd\n'x a\\b -o\n.br") == "\\&.so /etc/passwd\n\\&'x a\\eb \\-o\n.br"
    for text in PAGES.values():
        for line in text.splitlines():
            if line.startswith("."):
                assert line.split()[0] in {".TH", ".SH", ".TP", ".PP", ".B", ".BR", ".br"}, line


def test_they_are_written_twice_alike_and_nowhere_else(tmp_path):
    for folder in ("a", "deep/b"):
        done = CliRunner().invoke(yarc, ["man", str(tmp_path / folder)])
        assert (done.exit_code, done.output) == (
            0,
            f"{len(PAGES)} pages in {tmp_path / folder}: man yarc, man yarc-check\n",
        )
        assert {one.name: one.read_text() for one in (tmp_path / folder).iterdir()} == PAGES
    (tmp_path / "file").write_text("")
    done = CliRunner().invoke(yarc, ["man", str(tmp_path / "file" / "deeper")])
    assert done.exit_code == 1
    assert "can't be written" in done.output
    assert CliRunner().invoke(yarc, ["man"]).exit_code == 2
