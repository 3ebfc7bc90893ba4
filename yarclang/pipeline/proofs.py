"""Convert a certificate to the proof file that the small, separate checker of `yarc verify` reads."""

from __future__ import annotations

from yarclang.backend import backend_of
from yarclang.diagnostics import Diagnostic, Result
from yarclang.pipeline.stages import Compiled, claims_of


def proof_of(compiled: Compiled) -> Result[str]:
    """Return the proof of a compiled text; None, with a finding, if there is none."""
    robot, certificate = compiled.plan.robot, compiled.certificate
    backend = backend_of(robot)
    if backend.proof is None:
        return Result(
            None,
            (Diagnostic("Y1196", f"{backend.kind.title} has no checker of proofs", compiled.program.source),),
        )
    claims = claims_of(compiled.plan)
    made = backend.proof(
        compiled.text, certificate.text, compiled.program, robot, certificate.tolerance, claims
    )
    return Result(None, (made,)) if isinstance(made, Diagnostic) else Result(made)
