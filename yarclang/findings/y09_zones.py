"""Family 09, second part: zones of a cell. Y0905 said that zones aren't watched; they are."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0906",
        "unknown-part",
        "error",
        "a zone watches something that the robot doesn't have",
        "A zone watches the tool, the elbow, the arm, or links by their names in the URDF; a link without a collision shape has no room that could be watched. "
        "A name that nothing bears would be watched in silence by nobody.",
        'watch = ["tool", "forearm"]     # the URDF calls it link_4',
        'watch = ["tool", "link_4"]',
    ),
)
