"""Every command, declared: its name, what it does, who carries it out. Light to import."""

from __future__ import annotations

from dataclasses import dataclass

from hybridid_cli import helptexts


@dataclass(frozen=True)
class Command:
    """``handler`` is ``module:function`` taking ``(command name, words)``, imported when needed.

    ``configured`` commands have a primary config ``conf/<name>.yaml`` and take overrides.
    """

    name: str
    summary: str
    details: str
    handler: str
    configured: bool = True


_LISTS = "hybridid_cli.listing"
_STAGES = "hybridid_cli.hydra_app:run"

COMMANDS: tuple[Command, ...] = (
    Command("run", "every stage in order, from record to plots", helptexts.RUN, _STAGES),
    Command("preprocess", "read the records, check and filter them", helptexts.PREPROCESS, _STAGES),
    Command("fit", "estimate the parameters", helptexts.FIT, _STAGES),
    Command("residual", "fit a network to the error of the gray box", helptexts.RESIDUAL, _STAGES),
    Command("validate", "score the fitted model on every record", helptexts.VALIDATE, _STAGES),
    Command("plot", "draw the figures", helptexts.PLOT, _STAGES),
    Command("sweep", "many configs at once, in one table", helptexts.SWEEP, _STAGES),
    Command("reproduce", "the thesis' tables beside ours", helptexts.REPRODUCE, _STAGES),
    Command("trace", "find what the model lacks", helptexts.TRACE, _STAGES),
    Command("cases", "list the cases and their records", helptexts.CASES, f"{_LISTS}:cases", False),
    Command("effects", "list the physics that can be added", helptexts.EFFECTS, f"{_LISTS}:effects", False),
    Command("fetch", "download a case's public records", helptexts.FETCH, _STAGES),
    Command("tune", "search for the network, adaptively", helptexts.TUNE, _STAGES),
    Command("trust", "let code in a folder run", helptexts.TRUST, "hybridid_cli.trusting:command", False),
    Command("new", "a case from a recording", helptexts.NEW, "hybridid_cli.creating:command", False),
    Command("log", "send the runs that MLflow did not take", helptexts.LOG, _STAGES),
    Command("ui", "open the page of all runs (MLflow)", helptexts.UI, _STAGES),
    Command(
        "completion", "print the completion script of a shell", helptexts.COMPLETION,
        "hybridid_cli.completion:command", False,
    ),
)  # fmt: skip

BY_NAME = {command.name: command for command in COMMANDS}
