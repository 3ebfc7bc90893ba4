"""`yarc explain`."""

from __future__ import annotations

import click

from yarclang.cli.options import code_argument


@click.command("explain")
@code_argument("codes", nargs=-1, metavar="[CODE]...")
def command(codes: tuple[str, ...]) -> None:
    """Explain findings by their codes; without one, list all codes."""
    from yarclang.findings import FAMILIES
    from yarclang.lint.registry import everything
    from yarclang.subjects import suggest

    if not codes:
        for family, title in FAMILIES.items():
            entries = sorted(
                (finding for finding in everything().values() if finding.family == family),
                key=lambda one: one.code,
            )
            if entries:
                click.echo(click.style(f"{family} {title}", bold=True))
            for finding in entries:
                click.echo(f"  {finding.code}  {finding.severity:8}{finding.name:30}{finding.title}")
        return
    unknown = False
    for code in codes:
        known = [one for one in everything().values() if code.upper() == one.code or code.lower() == one.name]
        if not known:
            click.echo(f"no finding has the code {code}. {suggest(code, everything())}".rstrip(), err=True)
            unknown = True
            continue
        finding = known[0]
        click.echo(
            click.style(f"{finding.code} {finding.name} ({finding.severity}): {finding.title}", bold=True)
        )
        click.echo(f"\n{finding.why}")
        for title, text in (("For example", finding.example), ("Better", finding.better)):
            if text:
                click.echo(f"\n{title}:\n\n" + "\n".join(f"    {line}" for line in text.splitlines()))
    raise SystemExit(1 if unknown else 0)
