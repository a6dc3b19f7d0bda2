"""A run as a function of JAX: moments of inertia that were measured, found again by its gradient.

A run is no code that JAX could trace; its value is computed here, and so is its derivative, which JAX asks for by `jax.custom_vjp`.
"""

import jax
import jax.numpy as jnp
import numpy as np
from scipy.optimize import minimize

import coadjoint as co

jax.config.update("jax_enable_x64", True)

Body = co.System(group="SO3", inertia="inertia: Vector3 [kg m²]", derivatives="parameters", name="Body")
START = {"momentum": [0.3, 2.0, 0.4]}
STEP, END = 0.05, 10.0


def _solve(inertia):
    return Body(inertia=inertia).run(START, END, step=STEP)


@jax.custom_vjp
def momenta(inertia):
    """The body's momenta after each step, as they follow from its moments of inertia."""
    shape = jax.ShapeDtypeStruct((round(END / STEP) + 1, 3), jnp.float64)
    return jax.pure_callback(lambda inertia: np.array(_solve(np.asarray(inertia)).y.momentum), shape, inertia)


def _forward(inertia):
    return momenta(inertia), inertia


def _backward(inertia, covectors):
    def pull_back(inertia, covectors):
        sol = _solve(np.asarray(inertia))
        given = np.zeros_like(sol.y.flat)
        given[:, 4:7] = covectors
        return sol.gradient(given).parameters.flat

    return (jax.pure_callback(pull_back, jax.ShapeDtypeStruct((3,), jnp.float64), inertia, covectors),)


momenta.defvjp(_forward, _backward)

true = np.array([1.0, 2.0, 3.0])
measured = momenta(true)


def model(shape):
    # nothing acts, so that the size of all moments together is the clock's: the first is known
    return momenta(jnp.concatenate([jnp.ones(1), shape]))


guess = jnp.array([1.8, 3.3])
loss = jax.jit(jax.value_and_grad(lambda shape: jnp.mean((model(shape) - measured) ** 2)))
found = minimize(lambda shape: tuple(map(np.asarray, loss(shape))), guess, jac=True, method="BFGS", options={"gtol": 1e-12})
distance = float(np.abs(found.x - true[1:]).max())
print(f"found {found.x} in {found.nit} iterations: off by {distance:.1e}")
