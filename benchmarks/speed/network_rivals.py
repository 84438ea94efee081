"""Other ways to train a NARX network and to let it run free: torch sample by sample, and SysIdentPy.

All get the same samples, and in training the same start where they can.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from hybridid.residuals.narx import Weights
from hybridid.residuals.objective import Shape
from hybridid.residuals.samples import Samples
from hybridid.residuals.stretches import training

Array = NDArray[np.float64]
EPOCHS = 50
"""Of torch's training, which takes minutes: hence the rows say what objective each reached."""
SYSIDENTPY = find_spec("sysidentpy") is not None
"""``pip install sysidentpy``: we do not require it."""


def by_torch(samples: Samples, shape: Shape, decay: float, lbfgs: bool) -> tuple[float, int]:
    """Our objective from our start, sample by sample in torch, differentiated by autograd.

    Gives the objective that it reached, and its steps.
    """
    torch.set_num_threads(1)
    start = shape.parts(shape.start(np.random.default_rng([0, 0])))
    tensors = [torch.tensor(part, requires_grad=True) for part in start]
    error, rows = (torch.from_numpy(a) for a in samples.doubles)
    counts = torch.from_numpy(training(samples, shape.lags, None).counts) > 0

    def objective() -> torch.Tensor:
        left = (_run(tensors, rows, shape.lags) - error)[counts].square().mean()
        return left + 0.5 * decay * sum((t.square().sum() for t in tensors), torch.tensor(0.0))

    options: Any = {"lr": 1.0, "max_iter": EPOCHS, "history_size": 20, "line_search_fn": "strong_wolfe"}
    descent = torch.optim.LBFGS(tensors, **options) if lbfgs else torch.optim.Adam(tensors, lr=3e-3)

    def closure() -> torch.Tensor:
        descent.zero_grad()
        value = objective()
        value.backward()  # type: ignore[no-untyped-call]
        return value

    for _ in range(1 if lbfgs else EPOCHS):
        descent.step(closure)  # type: ignore[arg-type]
    return float(objective().detach()), EPOCHS


def run_by_torch(shape: Shape, flat: Array, rows: Array) -> Array:
    """The free run (m,) of the network with the weights ``flat``, sample by sample in torch."""
    torch.set_num_threads(1)
    with torch.no_grad():
        parts = [torch.from_numpy(part) for part in shape.layers(flat)]
        return np.asarray(_run(parts, torch.from_numpy(rows), shape.lags).numpy())


def _run(parts: list[torch.Tensor], rows: torch.Tensor, lags: int) -> torch.Tensor:
    by_past, by_rows, bias, hidden, biases, output, offset = parts
    driven, past, found = rows @ by_rows + bias, torch.zeros(lags, dtype=torch.float64), []
    for drive in driven:
        x = torch.nn.functional.elu(drive + past @ by_past)
        for matrix, shift in zip(hidden, biases, strict=True):
            x = torch.nn.functional.elu(shift + x @ matrix)
        found.append(offset + x @ output)
        past = torch.cat([found[-1], past[:-1]])
    return torch.cat(found)


def by_sysidentpy(
    samples: Samples, weights: Weights, judged: Callable[[Weights], float]
) -> tuple[float, int]:
    """SysIdentPy's ``NARXNN`` as it comes: Adam, one step ahead, single precision, all samples.

    Gives our objective at its weights, and its steps.
    """
    net, model, signals = _peer(samples, weights)
    torch.manual_seed(0)
    for layer in net:
        if isinstance(layer, torch.nn.Linear):
            layer.reset_parameters()
    model.fit(X=signals[:, 1:], y=signals[:, :1])
    linear = [layer for layer in net if isinstance(layer, torch.nn.Linear)]
    matrices = [layer.weight.detach().double().numpy() for layer in linear]
    biases = tuple(layer.bias.detach().double().numpy() for layer in linear)
    batches = -(-(len(signals) - model.max_lag) // model.batch_size)
    return judged(Weights(tuple(matrices), biases)), model.epochs * batches


def run_by_sysidentpy(samples: Samples, weights: Weights) -> Array:
    """Its free run with our weights; it begins after the longest lag."""
    _, model, signals = _peer(samples, weights)
    model.split_data(signals[:, 1:], signals[:, :1])
    return np.asarray(model.predict(X=signals[:, 1:], y=np.zeros((model.max_lag, 1))))[:, 0]


def _peer(samples: Samples, weights: Weights) -> tuple[torch.nn.Sequential, Any, Array]:
    """The network, its ``NARXNN``, and the signals (m, 4): error, two inputs, gray box."""
    from sysidentpy.basis_function import Polynomial
    from sysidentpy.neural_network import NARXNN

    torch.set_num_threads(1)
    layers: list[torch.nn.Module] = []
    for matrix, bias in zip(weights.matrices, weights.biases, strict=True):
        linear = torch.nn.Linear(matrix.shape[1], matrix.shape[0])
        with torch.no_grad():
            linear.weight.copy_(torch.from_numpy(matrix))
            linear.bias.copy_(torch.from_numpy(bias))
        layers += [linear, torch.nn.ELU()]
    net = torch.nn.Sequential(*layers[:-1])
    model = NARXNN(ylag=7, basis_function=Polynomial(degree=1), net=net)
    model.xlag = [
        [1, 2],
        [1, 2],
        [1, 2, 3, 4],
    ]  # the check of 0.9.0 refuses lags of several inputs; the rest can
    error, rows = samples.doubles
    inputs = np.vstack([rows[1:, [0, 2, 4]], rows[-1:, [0, 2, 4]]])
    return net, model, np.column_stack([error, inputs])
