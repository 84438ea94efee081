"""Three logs as they come from the field, simulated: from the file to the estimates, by two commands."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp


def estimates(folder: Path) -> dict[str, float]:
    (file,) = folder.glob("outputs/*/latest/fit/estimate.json")
    return {name: one["value"] for name, one in json.loads(file.read_text())["parameters"].items()}


def test_a_scooter_that_logs_nested_json_at_uneven_stamps(say, own_folder, rig):
    """The current is held for 2 s; the stamps count from 1970 and jitter; the mode is text."""
    noise = np.random.default_rng(4)
    t = np.cumsum(0.02 + noise.normal(0, 2e-3, 2000).clip(-0.01, 0.01))
    levels = noise.uniform(5, 30, 30)
    current = lambda s: levels[int(s // 2)]  # noqa: E731
    rate = lambda s, v: [(9.0 * current(s) - 14.0 - 1.2 * v[0] - 0.35 * v[0] ** 2) / 98.0]  # noqa: E731
    v = solve_ivp(rate, (0, t[-1]), [4.0], t_eval=t, max_step=0.02, rtol=1e-7).y[0]
    kmh = v * 3.6 + noise.normal(0, 5e-3, len(t))
    lines = (
        {"ts": 1.7e9 + s, "esc": {"current_A": current(s)}, "speed_kmh": speed, "mode": "eco"}
        for s, speed in zip(t, kmh, strict=True)
    )
    (own_folder / "ride.jsonl").write_text("\n".join(map(json.dumps, lines)))
    words = ("--from", "ride.jsonl", "--template", "vehicle", "--scale", "force=9", "--simulated")
    assert "uneven: resampled to 0.02 s" in say("new", rig, *words).out
    case = ("--config-dir", rig, f"case={rig}", "mlflow.enabled=false")
    said = say("fit", *case, "estimator.horizon=200")
    assert said.code == 0, said.err
    assert "measured" not in said.out
    found = estimates(own_folder)
    assert found["M"] == pytest.approx(98.0, rel=0.02)
    resisting = [found[f"road.{name}"] * 8.0**k for k, name in enumerate(("coulomb.f_c", "viscous.f_v"))]
    assert sum(resisting) + found["road.quadratic_drag.c_d"] * 64 == pytest.approx(46.0, rel=0.03)


def test_a_furnace_in_a_spreadsheet_of_another_language(say, own_folder, rig):
    """Dates, decimal commas, Latin-1, words above the header; a constant column gives the surroundings."""
    noise, share = np.random.default_rng(5), np.repeat([20.0, 90.0, 5.0, 60.0, 35.0], 120)
    warm = np.full(600, 22.0)
    for k in range(599):
        settled = 22.0 + 20.0 * share[k] / 2.5
        warm[k + 1] = settled + (warm[k] - settled) * np.exp(-2.5 * 2 / 1500.0)
    warm += noise.normal(0, 0.02, 600)
    rows = (
        f"25.11.2026 14:{k * 2 // 60:02}:{k * 2 % 60:02};{p:.1f};{q:.3f};22.0"
        for k, (p, q) in enumerate(zip(share, warm, strict=True))
    )
    text = ["Ofen 3", "Schicht A", "Datum;Heizung [%];Temperatur [°C];Umgebung [°C]", *rows]
    body = "\n".join(line if k < 3 else _commas(line) for k, line in enumerate(text))
    (own_folder / "ofen.csv").write_text(body, encoding="latin-1")
    words = ("--template", "heater", "--signal", "power=Heizung", "--scale", "power=20", "--simulated")
    said = say("new", rig, "--from", "ofen.csv", *words, "--constant", "T_0=Umgebung")
    assert said.code == 0, said.err
    assert "T_0 22" in said.out
    assert say("fit", "--config-dir", rig, f"case={rig}", "mlflow.enabled=false").code == 0
    assert estimates(own_folder) == pytest.approx({"C": 1500.0, "h": 2.5}, rel=0.02)


def test_a_house_that_logs_more_than_the_template_wants(say, own_folder, rig):
    """A thermostat, an outdoor sensor with a digit, humidities: the temperatures are found by their names."""
    noise, n = np.random.default_rng(6), 1200
    outside = (6.0 + 4.0 * np.sin(2 * np.pi * np.arange(n) / 288)).round(1)
    warm, power = np.full(n, 20.0), np.zeros(n)
    decay = np.exp(-60.0 * 300 / 2e6)
    for k in range(n - 1):
        power[k] = 2000.0 if warm[k] < (19.5 if k and not power[k - 1] else 21.0) else 0.0
        settled = outside[k] + power[k] / 60.0
        warm[k + 1] = settled + (warm[k] - settled) * decay
    rows = zip(power, outside, warm + noise.normal(0, 0.02, n), noise.uniform(30, 90, (n, 2)), strict=True)
    lines = (f"{300 * k},{p:g},{s:.1f},{w[0]:.0f},{q:.2f},{w[1]:.0f}" for k, (p, s, q, w) in enumerate(rows))
    names = "t [s],boiler,outdoor_temp,outdoor_humidity,room_temp,room_humidity"
    (own_folder / "house.csv").write_text("\n".join([names, *lines]))
    words = ("--template", "room", "--signal", "power=boiler", "--hold", "surroundings=zoh", "--simulated")
    said = say("new", rig, "--from", "house.csv", *words)
    assert said.code == 0, said.err
    assert say("fit", "--config-dir", rig, f"case={rig}", "mlflow.enabled=false").code == 0
    assert estimates(own_folder) == pytest.approx({"C": 2e6, "h": 60.0}, rel=0.02)


def _commas(line: str) -> str:
    """Decimal commas in all cells but the first, which is a date."""
    stamp, _, rest = line.partition(";")
    return f"{stamp};{rest.replace('.', ',')}"
