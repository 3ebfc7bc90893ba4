"""Knowledge about mutants: the tests of each package, and the reasons why some mutants survive."""

from __future__ import annotations

TESTS = {
    "motion": ["tests/motion"],
    "backend_pmac": ["tests/backend_pmac"],
    "robot": ["tests/robot/kinematics", "tests/certify/test_own_kinematics.py"],
    "transforms.py": ["tests/certify/test_own_kinematics.py"],
    "certify": [
        "tests/certify/test_sharp_edges.py",
        "tests/certify/test_exact_bounds.py",
        "tests/certify/test_own_kinematics.py",
        "tests/certify/test_certify_bounds.py",
        "tests/certify/test_certify_violations.py",
        "tests/certify/test_certify_proofs.py",
        "tests/certify/test_certify_torques.py",
        "tests/certify/test_forged.py",
    ],
    "collision": ["tests/collision"],
    "runtime": ["tests/runtime"],
}
"""Tests of each package, for modules that no test imports."""

ALSO = {
    "backend_pmac": ["tests/backend_pmac", "tests/certify/test_certify_read.py"],
    "certify/bodies/clearance.py": ["tests/collision/test_bodies.py"],
    "certify/motion/speed.py": ["tests/certify/test_certify_speed.py"],
    "certify/pmac/settings": ["tests/certify/test_certify_settings.py"],
    "collision/zones": ["tests/collision/test_bounds_by_hand.py", "tests/test_rejected.py"],
    "motion/limits.py": ["tests/test_golden.py"],
}
"""Tests that exercise files with these prefixes by commands, without importing them."""

REASONS: dict[str, str] = {
    "motion/limits.py dropped term: 1.0 - HEADROOM['jerk'] -> 1.0 (1)": "the text holds with its own claims: the judge tells a smaller share of the programmed speed "  # noqa: E501
    "(Y0610), where the plan without the change claims another",
    "motion/curve.py off by one: 6 -> 7 (1)": "as the one before: a slower text, which says so (Y0610)",
    "motion/timed.py wrong unit: 1e-09 -> 1.001e-09 (1)": "rounding of a number of steps, which is an integer but for 1e-12",  # noqa: E501
    "robot/kinematics/in_turn.py off by one: 0 -> 1 (5)": "turns that don't fit aren't sure, and poses that aren't sure are decided one by one",  # noqa: E501
    "collision/zones/proof.py wrong unit: 2.0 -> 2.002 (3)": "from which depth a place is told as broken: half of what isn't proved; what is open stays open",  # noqa: E501
    "motion/chains/flowing/window.py exchanged limits: ceiling[near] < speed * (1.0 - _SAME) -> "
    "ceiling[near] >= speed * (1.0 - _SAME) (1)": "the planner makes the chain in one piece instead: the same programs are written",  # noqa: E501
    "motion/together.py wrong axis: begun[0] -> begun[1] (1)": "all motions of one run of tries have a segment or none has",  # noqa: E501
    "backend_pmac/move_lines.py exchanged limits: rows >= _ROWS_AT_ONCE -> rows < _ROWS_AT_ONCE (1)": "how many lines are printed at once; they are the same",  # noqa: E501
    "certify/motion/proved.py off by one: 3 -> 4 (1)": "a claimed law that is never taken: the judge finds the shares of the path by itself",  # noqa: E501
    "certify/bodies/torque.py dropped term: (samples.row[chosen] - samples.row[chosen][0]) * h + samples "
    "-> (samples.row[chosen] - samples.row[chosen][0]) * h (1)": "when in a segment a torque is too large, in the words of a finding",  # noqa: E501
    "certify/flow.py sign: -1 -> 1 (3)": "the words of a finding about a condition",
    "motion/profiles/topp.py wrong unit: 0.005 -> 0.005005 (1)": "the longest segment of a law: segments are whole numbers of the grid's steps",  # noqa: E501
    "backend_pmac/decimals.py dropped term: 2.0 * _PATH_SHARE -> 2.0 (2)": "no program turns so much that the angle decides how many decimals are printed; the path judges "  # noqa: E501
    "them",
    "backend_pmac/decimals.py wrong unit: 0.05 -> 0.05005 (1)": "decimals are whole numbers",
    "robot/kinematics/search.py wrong unit: 0.5 -> 0.5005 (2)": "the order of starts of a search, of which many lead to each solution",  # noqa: E501
    "robot/kinematics/numeric.py wrong unit: 0.5 -> 0.5005 (3)": "when a fit counts as one, by 0.1 %",
    "robot/kinematics/nearest.py wrong unit: 1e-07 -> 1.0009999999999999e-07 (1)": "a tolerance, by 0.1 %",
    "robot/kinematics/nearest_spare.py dropped term: q + one.T @ np.linalg.solve(one @ one.T + DAMPED * "
    "np.eye(6) -> q (1)": "one of two values that are sampled besides 60 others: a better start alone",
    "certify/pmac/cursor.py off by one: 50000 -> 50001 (1)": "in which pieces lines are remembered",
    "certify/motion/posespline.py wrong unit: 2.0 -> 2.002 (3)": "about how long a path is, to name places on it: any names do",  # noqa: E501
    "certify/blends/blend.py wrong unit: DEG -> 1.0 (1)": "an angle in the words of a finding",
    "certify/pmac/settings/read.py wrong axis: found[0] -> found[1] (3)": "the words of a finding",
    "collision/bodies.py off by one: 0 -> 1 (3)": "HOME is the same in all scenes of a program",
    "collision/proof.py wrong unit: 0.001 -> 0.001001 (1)": "how closely a clearance is looked at; the second proof has it from below as well",  # noqa: E501
    "collision/geometry.py wrong unit: 2.0 -> 2.002 (1)": "a sum of solid angles is 0 or 4 pi; the threshold is between",  # noqa: E501
    "motion/trapezoid.py wrong unit: 1e-12 -> 1.0009999999999999e-12 (1)": "rounding",
    "motion/chains/flowing/law.py wrong axis: around[0] -> around[1] (1)": "the planner's: where only one end is a seam the law there is stretched as well, and what comes of "  # noqa: E501
    "it is judged as any other",
    "collision/zones/speed.py off by one: 0 -> 1 (5)": "when a search stops that has found what it wants: it goes on, with the same result",  # noqa: E501
}
"""Reasons for mutants that no check detected, or that certified a wrong text, by their keys in the file of
results.
"""
