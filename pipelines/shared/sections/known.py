"""What may stand in a config, section by section."""

from __future__ import annotations

from collections.abc import Mapping

from hybridid.settings import declared, keys
from hybridid.settings.fit import FitSettings
from pipelines.shared.sections.searches import SweepSection, TraceSection, TuneSection
from pipelines.shared.sections.stages import (
    ArchiveSection,
    CaseSection,
    ControllerSection,
    FitSection,
    LimitsSection,
    LoneKeys,
    MLflowSection,
    PathsSection,
    PlotSection,
    PreprocessSection,
    RigSection,
    UiKeys,
    ValidateSection,
)

SECTIONS: Mapping[str, type] = {
    "case": CaseSection,
    "archive": ArchiveSection,
    "preprocess": PreprocessSection,
    "estimator": FitSettings,
    "fit": FitSection,
    "validate": ValidateSection,
    "controller": ControllerSection,
    "plot": PlotSection,
    "trace": TraceSection,
    "sweep": SweepSection,
    "tune": TuneSection,
    "rig": RigSection,
    "limits": LimitsSection,
    "paths": PathsSection,
    "mlflow": MLflowSection,
}
"""Sections whose keys are always the same."""
FREE = ("plant", "records", "signals", "channels", "effects", "parameters", "residual")
"""Keys below which the case, or the kind of network, decides what may stand."""
LONE: tuple[type, ...] = (LoneKeys, UiKeys)
"""Keys that stand in no section."""
KEYS: tuple[str, ...] = (*SECTIONS, *FREE, *(key for cls in LONE for key in keys(cls)))
"""All that may stand at the top of a config."""


def unit_of(key: str) -> str:
    """Of a setting by its dotted name, such as ``estimator.horizon``; empty if it has none."""
    name = key.partition(".")[0]
    found = declared(SECTIONS[name], f"{name}.") if name in SECTIONS else ()
    return next((one.setting.unit for one in found if one.name == key), "")
