"""The package of `examples/compiled`: a struct of Rust is what its text is."""

import pickle

import numpy as np
import pytest

my_bodies = pytest.importorskip("my_bodies", reason="the example of a package that is compiled ahead is not installed")


@pytest.fixture(scope="module")
def ahead():
    return my_bodies.HeavyTop(inertia=[1, 10, 100], weight=1, chi=[0, 0, 1])


@pytest.mark.parametrize("scheme", ["exponential", "cayley"])
def test_its_runs_have_the_bytes_of_its_text(top, y0, ahead, scheme):
    sol, text = (one.run(y0.flat, 20, step=0.01, scheme=scheme) for one in (ahead, top))
    assert (sol.y.flat == text.y.flat).all() and (sol.energy == text.energy).all() and (sol.casimirs == text.casimirs).all()
    assert ahead.system.state_quantities[1].unit is None and ahead.system._parameters.quantities[0].unit == "kg m²"


def test_its_ensembles_have_too(top, y0, ahead):
    momenta = np.linspace([1, 1, 1], [2, 1, 3], 37)
    known, text = (
        one.ensemble({"momentum": momenta, "gamma": [0, 0, 1]}, t_span=5, step=0.01, every=100) for one in (ahead, top)
    )
    assert (known.y.flat == text.y.flat).all()
    assert pickle.loads(pickle.dumps(ahead)) == ahead
