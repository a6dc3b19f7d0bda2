import numpy as np
import pytest

import coadjoint as co

HEAVY_TOP = {
    "group": "SO3",
    "advected": "gamma: R3",
    "potential": "weight * gamma.dot(&chi)",
    "inertia": "inertia: Vector3 [kg m²]",
    "parameters": "weight: float [N], chi: Vector3 [m]",
    "name": "HeavyTop",
}


@pytest.fixture(scope="session")
def HeavyTop():
    return co.System(**HEAVY_TOP)


@pytest.fixture(scope="session")
def top(HeavyTop):
    return HeavyTop(inertia=[1, 10, 100], weight=1, chi=[0, 0, 1])


@pytest.fixture()
def y0(top):
    return top.state(momentum=[1, 1, 1], gamma=[0, 0, 1])


@pytest.fixture(scope="session")
def cart():
    """A cart on a line that is pushed, tied by a spring."""
    return co.System(
        group="R1",
        control="push: R1",
        potential="0.5 * stiffness * position.norm_squared()",
        force="push",
        inertia="mass: float [kg]",
        parameters="stiffness: float [N/m]",
        name="Cart",
    )(mass=2.0, stiffness=0.0)


@pytest.fixture(scope="session")
def oscillator(cart):
    return cart.replace(stiffness=8.0)


def pytest_configure():
    np.seterr(all="raise", under="ignore")
