"""Build hook: a wheel carries ``conf/`` inside ``hybridid_cli``, an editable install does not."""

from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class ConfInWheel(BuildHookInterface):
    """Force-includes ``conf`` in standard wheels only: a copy in an editable install would go stale."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if version == "standard":
            build_data["force_include"]["conf"] = "hybridid_cli/conf"
