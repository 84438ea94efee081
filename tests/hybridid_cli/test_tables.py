"""What the terminal's tables share: words stand left, numbers right, what is simulated stands out."""

from __future__ import annotations

from hybridid_cli.tables import provenance, rendered, table, view, warnings


def test_words_stand_left_and_numbers_right():
    made = table("Scores", ("record", "RMSE", "data"), words=(0, 2))
    made.add_row("a", "1 mm", provenance("measured"))
    made.add_row("second", "123 mm", provenance("simulated"))
    lines = rendered([made]).splitlines()
    title, header, rows = lines[0], lines[2], lines[4:6]
    assert title == "Scores"
    assert rows[0].split() == ["a", "1", "mm", "measured"]
    assert rows[1].split() == ["second", "123", "mm", "simulated"]
    assert all(row.index("mm") + 2 == header.index("RMSE") + 4 for row in rows)
    assert rows[0].index("measured") == rows[1].index("simulated") == header.index("data")


def test_what_is_simulated_stands_out():
    assert provenance("simulated").style == "bold magenta"
    assert provenance("measured").style == ""


def test_views_and_warnings_in_words():
    assert (view(None), view(1.0), view(0.05)) == ("free run", "horizon 1 s", "horizon 0.05 s")
    assert rendered(warnings(["record first: clipped", "short"])).splitlines() == [
        "WARNING: record first: clipped",
        "WARNING: short",
    ]
