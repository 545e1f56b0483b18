"""What the wheel takes from beside the package: an editable install uses the repository's own folders."""

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SHIPPED = ("fmus", "ssp", "scenarios", "studies", "docs/examples")


class Shipped(BuildHookInterface):
    """Puts ships, systems, scenarios, studies, FMUs and examples into the wheel, where `library` finds them."""

    def initialize(self, version, build_data):
        if version != "editable":
            build_data["force_include"] |= {
                folder: f"shipcosim/shipped/{folder}" for folder in SHIPPED
            }
