"""Colours and line styles that are distinct without colour and for any colour vision; kinds of files."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

# Okabe and Ito (2008), "Color universal design": distinct for any colour vision
BLUE, VERMILION, GREEN = "#0072B2", "#D55E00", "#009E73"
PURPLE, ORANGE, SKY = "#CC79A7", "#E69F00", "#56B4E9"
INK, SOFT_INK, DATA_GREY, GRID_GREY = "#222222", "#666666", "#A0A0A0", "#E4E4E4"
FOCUS = "#FFF6DC"  # background of the part that another panel enlarges
MASKED = "#EBEBEB"  # background of a stretch that does not count

Kind = Literal["svg", "pdf", "png"]
KINDS: tuple[Kind, ...] = get_args(Kind)
"""Files that a figure is written as."""

Dashes = tuple[float, tuple[float, ...] | None]
SOLID: Dashes = (0.0, None)
DASHED: Dashes = (0.0, (5.0, 1.2))
DASH_DOTTED: Dashes = (0.0, (5.0, 1.2, 1.0, 1.2))
DOTTED: Dashes = (0.0, (1.4, 1.0))
LONG_DOTTED: Dashes = (0.0, (8.0, 1.2, 1.0, 1.2, 1.0, 1.2))


@dataclass(frozen=True)
class Look:
    """The look of one series; ``above`` is its drawing order."""

    colour: str
    dashes: Dashes = SOLID
    width: float = 0.9
    above: int = 3


DATA = Look(DATA_GREY, width=2.0, above=2)
_COLOURS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)
_DASHES = (SOLID, DASHED, DASH_DOTTED, DOTTED, LONG_DOTTED)


def look(index: int) -> Look:
    """The look of series ``index``: 6 colours and 5 dash patterns give 30 different looks."""
    return Look(_COLOURS[index % len(_COLOURS)], _DASHES[index % len(_DASHES)])
