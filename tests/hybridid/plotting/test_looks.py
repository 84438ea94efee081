"""Series differ in colour and in dashes, also on a grey print."""

from __future__ import annotations

from matplotlib.colors import to_rgb

from hybridid.plotting.looks import DATA, look


def test_thirty_series_differ():
    assert len({(look(k).colour, look(k).dashes) for k in range(30)}) == 30


def test_neighbours_differ_without_colour():
    assert all(look(k).dashes != look(k + 1).dashes for k in range(30))


def test_data_are_broader_and_paler_than_any_model():
    def lightness(colour: str) -> float:
        red, green, blue = to_rgb(colour)
        return 0.2126 * red + 0.7152 * green + 0.0722 * blue

    assert all(DATA.width > 2 * look(k).width for k in range(6))
    assert all(lightness(DATA.colour) > lightness(look(k).colour) for k in range(3))
