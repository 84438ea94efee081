"""Hybrids simulate free-run like a gray box, say when they diverge, and survive a file."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from hybridid.estimators import FitSettings, fit
from hybridid.hybrid import OutputErrorHybrid, PortHybrid, load_hybrid, save_hybrid
from hybridid.hybrid.files import HybridFileError
from hybridid.records.record import Channel, Record
from hybridid.residuals.orders import Orders
from hybridid.residuals.rbf import RBFNetwork
from hybridid.residuals.rbf_fit import RBFPlan, fit_rbf
from hybridid.residuals.series import error_series
from hybridid.residuals.settings import Architecture, Training
from hybridid.residuals.training import Task, train
from hybridid.simulation.simulate import Diverged
from hybridid.validation import free_run, horizon_run, metrics

SENSOR = 2e-4
"""m; size of the simulated error."""


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.fixture(scope="module")
def gray(make_model):
    return make_model()


@pytest.fixture(scope="module")
def bent_sensor(carriage):
    """Carriages whose encoder adds a lagged function of the force, which no gray box holds; simulated."""

    def record(n, phase):
        made = carriage.record(n)
        force = np.roll(made.inputs[:, 0], phase) if phase else made.inputs[:, 0]
        error = np.zeros(n)
        for t in range(1, n):
            error[t] = 0.9 * error[t - 1] + 0.1 * SENSOR * np.tanh(force[t - 1] / 30)
        return replace(made, outputs=made.outputs + error[:, None], name=f"bent {n}")

    return record


@pytest.fixture(scope="module")
def narx_hybrid(gray, carriage, bent_sensor):
    record = bent_sensor(600, 0)
    series = error_series(free_run(gray, carriage.truth, record), record, "position")
    architecture = Architecture(Orders(2, (2,), 1), depth=2, width=8)
    settings = Training(horizons=(1, 20), epochs=40, patience=8, batch=128, learning_rate=5e-3)
    return OutputErrorHybrid(gray, carriage.truth, (train(Task((series,), architecture), settings).network,))


@pytest.fixture(scope="module")
def rbf_hybrid(gray, carriage):
    network = RBFNetwork(3, (-0.2, 0.2))
    weights = {"carriage.rbf.w_1": 2.0, "carriage.rbf.w_2": -1.0, "carriage.rbf.w_3": 3.0}
    model = gray.plus(network.effect(gray.plant.port("carriage")), "carriage")
    values = dict(
        zip([p.name for p in model.parameters], model.values({**carriage.truth, **weights}), strict=True)
    )
    return PortHybrid(gray, values, network, "carriage", ("carriage",), "simulated")


class TestOutputError:
    def test_lowers_the_error_of_an_unseen_stretch(self, gray, carriage, narx_hybrid, bent_sensor):
        unseen = bent_sensor(1000, 0).part(600, 1000)
        alone = free_run(gray, carriage.truth, unseen)
        assert rms(narx_hybrid.free_run(unseen).error) < 0.5 * rms(alone.error)

    def test_is_the_gray_box_plus_the_network(self, gray, carriage, narx_hybrid, bent_sensor):
        record = bent_sensor(600, 0)
        alone = free_run(gray, carriage.truth, record)
        together = narx_hybrid.free_run(record)
        correction = narx_hybrid.correction(alone, record)
        np.testing.assert_allclose(together.predicted, alone.predicted + correction)
        assert together.view == "free_run"
        (row,) = metrics(together, narx_hybrid.name)
        assert row.rmse == pytest.approx(rms(together.error[:, 0]))
        assert (row.model, row.provenance) == ("hybrid, NARX 2 x 8", "simulated")

    def test_horizons_are_corrected_one_by_one(self, gray, carriage, narx_hybrid, bent_sensor):
        record = bent_sensor(600, 0)
        alone = horizon_run(gray, carriage.truth, record, 200)
        correction = narx_hybrid.horizon_run(record, 200).predicted - alone.predicted
        own = narx_hybrid.correction(horizon_run(gray, carriage.truth, record, 200), record)
        np.testing.assert_allclose(correction, own, atol=1e-15)
        assert alone.breaks == (0, 200, 400)
        in_one_go = narx_hybrid.correction(replace(alone, breaks=(0,)), record)
        assert rms(in_one_go[:200] - own[:200]) < 1e-15
        assert rms(in_one_go[200:220] - own[200:220]) > 0.01 * rms(own)

    def test_running_away_is_said_with_its_time(self, narx_hybrid, bent_sensor):
        (network,) = narx_hybrid.networks
        tight = replace(narx_hybrid, networks=(replace(network, limit=0.2 * SENSOR),))
        with pytest.raises(
            Diverged,
            match=r"network for position diverged on record bent 600 at t = \d.*: \|error\| above 4e-05 m",
        ):
            tight.free_run(bent_sensor(600, 0))

    def test_explained_by_physics(self, narx_hybrid, bent_sensor):
        found = narx_hybrid.explained(bent_sensor(600, 0))
        assert 0.0 <= found.share <= 1.0
        assert set(found.alone) == {
            "M",
            "carriage.viscous.f_v",
            "carriage.coulomb.f_c",
            "carriage.offset.offset",
        }

    @pytest.mark.parametrize("twice", [True, False])
    def test_one_network_an_output(self, narx_hybrid, twice):
        (network,) = narx_hybrid.networks
        given = (network, network) if twice else (replace(network, output="velocity"),)
        with pytest.raises(ValueError, match="one at most for each of position"):
            replace(narx_hybrid, networks=given)


class TestPort:
    def test_is_the_model_with_the_network_inside(self, rbf_hybrid, carriage):
        record = carriage.record(300)
        expected = free_run(rbf_hybrid.model, rbf_hybrid.values, record)
        np.testing.assert_array_equal(rbf_hybrid.free_run(record).predicted, expected.predicted)
        assert rbf_hybrid.horizon_run(record, 100).breaks == (0, 100, 200)
        assert rbf_hybrid.name == "hybrid, RBF with 3 nodes"

    def test_explained_by_physics(self, rbf_hybrid, carriage):
        found = rbf_hybrid.explained(carriage.record(300))
        assert 0.0 < found.share < 1.0
        assert not [name for name in found.alone if "rbf" in name]


class TestFiles:
    def test_a_narx_hybrid_comes_back(self, narx_hybrid, gray, bent_sensor, tmp_path):
        record = bent_sensor(600, 0)
        save_hybrid(narx_hybrid, tmp_path / "residual")
        again = load_hybrid(tmp_path / "residual", gray)
        np.testing.assert_array_equal(
            again.free_run(record).predicted, narx_hybrid.free_run(record).predicted
        )
        assert again.networks[0].architecture == narx_hybrid.networks[0].architecture
        assert again.networks[0].scaling == narx_hybrid.networks[0].scaling
        assert (again.name, again.provenance) == (narx_hybrid.name, "simulated")

    def test_an_rbf_hybrid_comes_back(self, rbf_hybrid, gray, carriage, tmp_path):
        record = carriage.record(300)
        save_hybrid(rbf_hybrid, tmp_path)
        again = load_hybrid(tmp_path, gray)
        np.testing.assert_array_equal(again.free_run(record).predicted, rbf_hybrid.free_run(record).predicted)
        assert again.network == rbf_hybrid.network

    def test_no_pickle_and_nothing_else_left(self, narx_hybrid, tmp_path):
        save_hybrid(narx_hybrid, tmp_path)
        assert sorted(path.name for path in tmp_path.iterdir()) == ["hybrid.json", "weights.npz"]
        with np.load(tmp_path / "weights.npz", allow_pickle=False) as arrays:
            assert arrays["position.0.matrix"].shape == (1, 8, 5)

    def test_members_come_back_and_so_does_a_file_of_one_without_their_axis(
        self, narx_hybrid, gray, tmp_path
    ):
        (network,) = narx_hybrid.networks
        (one,) = network.members
        other = replace(one, matrices=tuple(0.5 * matrix for matrix in one.matrices))
        two = replace(narx_hybrid, networks=(replace(network, members=(one, other)),))
        save_hybrid(two, tmp_path)
        (again,) = load_hybrid(tmp_path, gray).networks
        assert len(again.members) == 2
        assert again.count == network.count
        np.testing.assert_array_equal(again.members[1].matrices[2], other.matrices[2])
        save_hybrid(narx_hybrid, tmp_path)
        with np.load(tmp_path / "weights.npz") as arrays:
            earlier = {name: array[0] for name, array in arrays.items()}
        np.savez(tmp_path / "weights.npz", **earlier)
        (again,) = load_hybrid(tmp_path, gray).networks
        np.testing.assert_array_equal(again.members[0].biases[1], one.biases[1])

    def test_a_network_without_members_leaves_the_gray_box(self, narx_hybrid, gray, bent_sensor, tmp_path):
        (network,) = narx_hybrid.networks
        save_hybrid(replace(narx_hybrid, networks=(network.silent(),)), tmp_path)
        again = load_hybrid(tmp_path, gray)
        record = bent_sensor(600, 0)
        expected = free_run(gray, narx_hybrid.values, record)
        np.testing.assert_array_equal(again.free_run(record).predicted, expected.predicted)
        assert (again.name, again.provenance) == ("gray box, no network kept", "simulated")
        assert again.explained(record).share == 0.0

    def test_another_model_is_refused(self, rbf_hybrid, make_model, tmp_path):
        save_hybrid(rbf_hybrid, tmp_path)
        with pytest.raises(HybridFileError, match=r"another model, they differ in carriage\.stribeck\.df_s"):
            load_hybrid(tmp_path, make_model(("viscous", "coulomb", "offset", "stribeck")))

    @pytest.mark.parametrize("text", ["", "[]", json.dumps({"format": 99})])
    def test_what_is_no_hybrid_is_refused(self, gray, tmp_path, text):
        (tmp_path / "hybrid.json").write_text(text)
        with pytest.raises(HybridFileError, match=r"hybrid\.json"):
            load_hybrid(tmp_path, gray)

    @pytest.mark.parametrize(
        ("changed", "said"),
        [
            ({"physics": 3}, "not as hybridid writes it"),
            ({"kind": "theirs:NETWORK"}, "unknown kind 'theirs:NETWORK': allowed: narx, rbf"),
            ({"kind": []}, "not as hybridid writes it"),
            ({"network": None}, r"hybrid\.json: network: expected a mapping"),
            ({"records": 3}, "not as hybridid writes it"),
        ],
    )
    def test_a_changed_description_is_refused(self, rbf_hybrid, gray, tmp_path, changed, said):
        path = save_hybrid(rbf_hybrid, tmp_path)
        path.write_text(json.dumps(json.loads(path.read_text()) | changed))
        with pytest.raises(HybridFileError, match=said):
            load_hybrid(tmp_path, gray)

    def test_a_description_that_lacks_a_key_is_refused(self, rbf_hybrid, gray, tmp_path):
        path = save_hybrid(rbf_hybrid, tmp_path)
        whole = json.loads(path.read_text())
        for key in whole:
            path.write_text(json.dumps({name: value for name, value in whole.items() if name != key}))
            with pytest.raises(HybridFileError, match=r"hybrid\.json"):
                load_hybrid(tmp_path, gray)

    @pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"PK\x05\x06" + bytes(18), b"\x80\x04."])
    def test_weights_that_are_no_archive_are_named(self, narx_hybrid, gray, tmp_path, content):
        save_hybrid(narx_hybrid, tmp_path)
        (tmp_path / "weights.npz").write_bytes(content)
        with pytest.raises(HybridFileError, match=r"weights\.npz: not the weights that belong"):
            load_hybrid(tmp_path, gray)

    def test_missing_weights_are_named(self, narx_hybrid, gray, tmp_path):
        save_hybrid(narx_hybrid, tmp_path)
        (tmp_path / "weights.npz").unlink()
        with pytest.raises(HybridFileError, match=r"weights\.npz"):
            load_hybrid(tmp_path, gray)


def emps(root, file, name):
    from pymatreader import read_mat

    data = read_mat(str(root / "emps" / file))
    return Record(
        name=name,
        time=data["t"].ravel(),
        inputs=(data["gtau"] * data["vir"]).reshape(-1, 1),
        outputs=data["qm"].reshape(-1, 1),
        input_channels=(Channel("force", "N", "zoh"),),
        output_channels=(Channel("position", "m"),),
    )


def test_the_measured_emps_beats_the_thesis(measured):
    """The thesis' hybrids: 3.6 mm on the identification record, 3.5 to 3.6 mm on the validation record."""
    from hybridid.model import compose
    from hybridid.plants.emps import EMPS

    record, other = emps(measured, "DATA_EMPS.mat", "id"), emps(measured, "DATA_EMPS_PULSES.mat", "val")
    model = compose(EMPS(), ("viscous", "coulomb", "offset"))
    settings = FitSettings(horizon=5000, max_iterations=30)
    values = fit(model, [record], settings).values
    found = fit_rbf(model, values, [record], RBFPlan(nodes=4), settings)
    hybrid = PortHybrid(model, found.estimate.values, found.network, "carriage", ("id",), "measured")
    assert rms(hybrid.free_run(record).error) < 2.0e-3
    assert rms(hybrid.free_run(other).error) < 3.6e-3
