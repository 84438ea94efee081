"""Other ways to fit the EMPS: the four parameters that make a simulation agree with the recorded position.

    M a = force - f_v v - f_c tanh(v / epsilon) - offset          RK4, one step a sample, the force held

All ways minimise the same sum of squares from the same initial states, those of the record, and start at the
case's guesses. None differentiates by hand: that is what an engineer has without this package. Each gives the
parameters (4,): M, f_v, f_c, offset in SI units.
"""

from __future__ import annotations

from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from typing import Any

import casadi as ca
import numba
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Task:
    """``force`` and ``position`` (w, n) of w horizons, and initial states ``x0`` (w, 2: velocity, position).

    ``guess``, bounds and ``scale`` (4,) are those of the parameters, in SI units. ``used`` (w, n): those that
    count.
    """

    dt: float
    force: Array
    position: Array
    used: NDArray[np.bool_]
    x0: Array
    epsilon: float
    guess: Array
    lower: Array
    upper: Array
    scale: Array

    def errors(self, simulated: Array) -> Array:
        """Simulated minus recorded position of every sample that counts, [m]."""
        return (simulated - self.position)[self.used]

    def rmse(self, p: Array) -> float:
        """Of the position [m] with the parameters ``p`` (4,): one simulation judges all ways."""
        left = self.errors(_simulate(self.force, self.x0, p, self.epsilon, self.dt))
        return float(np.sqrt(np.mean(left**2)))


@numba.njit(cache=False)
def _acceleration(v: float, force: float, p: Array, epsilon: float) -> float:
    return (force - p[1] * v - p[2] * np.tanh(v / epsilon) - p[3]) / p[0]


@numba.njit(cache=False)
def _simulate(force: Array, x0: Array, p: Array, epsilon: float, h: float) -> Array:
    w, n = force.shape
    found = np.empty((w, n))
    for i in range(w):
        v, q = x0[i]
        for k in range(n):
            found[i, k] = q
            u = force[i, k]
            a1 = _acceleration(v, u, p, epsilon)
            v2 = v + h / 2 * a1
            a2 = _acceleration(v2, u, p, epsilon)
            v3 = v + h / 2 * a2
            a3 = _acceleration(v3, u, p, epsilon)
            v4 = v + h * a3
            a4 = _acceleration(v4, u, p, epsilon)
            q += h / 6 * (v + 2 * v2 + 2 * v3 + v4)
            v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return found


def by_numba(task: Task) -> Array:
    """``least_squares`` over an RK4 compiled by numba, derivatives by differences."""
    return _least_squares(task, lambda p: _simulate(task.force, task.x0, p, task.epsilon, task.dt))


def by_solve_ivp(task: Task) -> Array:
    """``least_squares`` over ``solve_ivp`` (RK45 as it comes, at most a sample a step), the force held."""
    return _least_squares(task, lambda p: np.stack([_integrated(task, k, p) for k in range(len(task.x0))]))


def _integrated(task: Task, k: int, p: Array) -> Array:
    force, n = task.force[k], task.force.shape[1]

    def rates(t: float, x: Array) -> list[float]:
        u = force[min(int(t / task.dt + 1e-9), n - 1)]
        return [(u - p[1] * x[0] - p[2] * np.tanh(x[0] / task.epsilon) - p[3]) / p[0], x[0]]

    times = task.dt * np.arange(n)
    found = solve_ivp(rates, (0.0, times[-1]), task.x0[k], t_eval=times, max_step=task.dt)
    return np.asarray(found.y[1])


def _least_squares(task: Task, simulate: Any) -> Array:
    scale = task.scale

    def errors(z: Array) -> Array:
        return 1e3 * task.errors(simulate(z * scale))

    bounds = (task.lower / scale, task.upper / scale)
    found = least_squares(errors, task.guess / scale, bounds=bounds, x_scale="jac")
    return np.asarray(found.x * scale)


def by_every_sample(task: Task) -> Array:
    """The thesis' transcription: the state of every sample is a variable of one nonlinear program, each step
    a constraint; CasADi's exact Hessian, IPOPT. It starts at the recorded positions."""
    p, scale = ca.MX.sym("p", 4), task.scale
    step = _step(task)
    variables, guesses, constraints, cost = [p], [task.guess / scale], [], 0.0
    for k, start in enumerate(task.x0):
        n = int(task.used[k].sum())
        x = ca.MX.sym(f"x{k}", 2, n)
        variables.append(ca.vec(x))
        velocity = np.gradient(task.position[k, :n], task.dt)
        guesses.append(np.vstack([velocity, task.position[k, :n]]).T.ravel())
        after = step.map(n - 1)(x[:, :-1], task.force[k, : n - 1].reshape(1, -1), ca.repmat(p, 1, n - 1))
        constraints += [ca.vec(x[:, 0] - start), ca.vec(x[:, 1:] - after)]
        cost += ca.sumsqr(1e3 * (x[1, :] - task.position[k, :n].reshape(1, -1)))
    unknown = ca.vertcat(*variables)
    free = unknown.shape[0] - 4
    program = {"x": unknown, "f": cost, "g": ca.vertcat(*constraints)}
    options = {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes", "ipopt.max_iter": 200}
    found = ca.nlpsol("fit", "ipopt", program, options)(
        x0=np.concatenate(guesses),
        lbx=np.concatenate([task.lower / scale, np.full(free, -np.inf)]),
        ubx=np.concatenate([task.upper / scale, np.full(free, np.inf)]),
        lbg=0,
        ubg=0,
    )
    return np.asarray(found["x"][:4]).ravel() * scale


def by_jax_sysid(task: Task) -> Array:
    """jax-sysid's ``Model`` with the same step: all horizons in one scan, L-BFGS-B, gradients by JAX.

    The cost is its own default, the sum of squares, without its penalties on parameters and initial states.
    Each call compiles its model: that is how ``fit`` of jax-sysid comes. We do not require it:
    ``pip install jax jax-sysid``.
    """
    import jax
    import jax.numpy as jnp
    from jax_sysid.models import Model

    jax.config.update("jax_enable_x64", True)
    w, h, scale, used = len(task.x0), task.dt, jnp.array(task.scale), jnp.array(task.used.T)

    def rate(v: Any, u: Any, p: Any) -> Any:
        return (u - p[1] * v - p[2] * jnp.tanh(v / task.epsilon) - p[3]) / p[0]

    def step(x: Any, u: Any, given: Any) -> Any:
        p, v, q = given[0] * scale, x[:w], x[w:]
        a1 = rate(v, u, p)
        a2 = rate(v2 := v + h / 2 * a1, u, p)
        a3 = rate(v3 := v + h / 2 * a2, u, p)
        v4 = v + h * a3
        after = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + rate(v4, u, p))
        return jnp.concatenate([after, q + h / 6 * (v + 2 * v2 + 2 * v3 + v4)])

    model = Model(2 * w, w, w, state_fcn=step, output_fcn=lambda x, u, given: x[w:])
    model.loss(lambda y, seen: 1e6 * jnp.sum(used * (y - seen) ** 2), rho_x0=0.0, rho_th=0.0, train_x0=False)
    model.optimization(adam_epochs=0, lbfgs_epochs=1000, iprint=-1)
    model.init(params=[task.guess / task.scale], x0=task.x0.T.ravel())
    model.params_min, model.params_max = [task.lower / task.scale], [task.upper / task.scale]
    with redirect_stdout(StringIO()):
        model.fit(task.position.T, task.force.T)
    return np.asarray(model.params[0]) * task.scale


def _step(task: Task) -> ca.Function:
    x, u, z = ca.SX.sym("x", 2), ca.SX.sym("u"), ca.SX.sym("z", 4)
    p, h = z * ca.DM(task.scale), task.dt

    def rate(y: ca.SX) -> ca.SX:
        v = y[0]
        return ca.vertcat((u - p[1] * v - p[2] * ca.tanh(v / task.epsilon) - p[3]) / p[0], v)

    k1 = rate(x)
    k2 = rate(x + h / 2 * k1)
    k3 = rate(x + h / 2 * k2)
    k4 = rate(x + h * k3)
    return ca.Function("step", [x, u, z], [x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])
