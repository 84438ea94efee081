"""A proposed law as an effect file, which ``effects=`` and ``trace.extra_effects=`` take up as it stands."""

from __future__ import annotations

from hybridid.effects.effect import Effect
from hybridid.quantities import estimated
from hybridid.trace.entries import AcceptedEffect
from hybridid.trace.results.result import Trace
from hybridid.trace.words.remarks import equation_in_words
from pipelines.shared.augmented import as_settings

NAME = "proposed_law.py"
_TEXT = '''"""A law that hybridid trace proposed for the case {case} ({provenance}).

    {equation}   at {port}

{values}

Name it as any effect of your own, with --config-dir FOLDER_OF_THIS_FILE. For a case of your own, copy this
file into the folder of that case, which is the --config-dir already:

    effects=[..., {module}:{constant}@{port}]
    trace.extra_effects=[{module}:{constant}]
{widths}"""

from hybridid.effects.composed import law

{constant} = law({arguments})
'''


_WIDTHS = """
It was fitted with sign(v) smoothed more narrowly than declared. So say beside it:

    {settings}
"""


def law_files(found: Trace, case: str) -> dict[str, str]:
    """The text of a file for each law that ``found`` proposes, by its name; several are numbered."""
    laws = [entry for entry in found.accepted if entry.is_law]
    effects = {term.name: term.effect for term in found.model.terms}
    names = [NAME] if len(laws) == 1 else [f"{NAME[:-3]}_{n}.py" for n in range(1, len(laws) + 1)]
    return {
        name: _text(entry, effects[entry.name], name.removesuffix(".py"), case, found)
        for name, entry in zip(names, laws, strict=True)
    }


def _text(entry: AcceptedEffect, effect: Effect, module: str, case: str, found: Trace) -> str:
    units = {signal.name: signal.unit for signal in found.model.signals}
    signals = "".join(f", over=({name!r}, {units[name]!r})" for name in effect.channels)
    kind = f", at={effect.kind!r}" if effect.kind == "flow" else ""
    values = {**entry.parameters, **entry.known}
    guesses = "".join(f", {name}={value.value:.9g}" for name, value in values.items())
    settings = " ".join(as_settings(found.narrowed))
    return _TEXT.format(
        case=case,
        provenance=found.provenance,
        equation=equation_in_words(entry),
        port=entry.port,
        values="\n".join(
            f"    {name} = {estimated(value.value, value.std, value.unit)}"
            for name, value in entry.parameters.items()
        ),
        module=module,
        constant=entry.effect.upper(),
        widths=_WIDTHS.format(settings=settings) if settings else "",
        arguments=f"{entry.effect!r}{signals}{kind}{guesses}".replace("'", '"'),
    )
