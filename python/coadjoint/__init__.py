"""Structure-preserving steppers for mechanics on Lie groups.

Describe a rigid body, a spacecraft or a pendulum in a string: its group, its inertia, its potential. The equations are derived from it when it is read, and
steps keep momentum, Casimirs and attitude to rounding.

>>> import coadjoint as co
>>> Pendulum = co.System(
...     group="SO2",
...     potential="-weight * angle.cos_angle()",
...     inertia="inertia: float [kg m²]",
...     parameters="weight: float [N m]",
... )
>>> pendulum = Pendulum(inertia=1, weight=9.81)
>>> sol = pendulum.run({"momentum": [0.5]}, t_span=10, step=0.01)
>>> sol.y.momentum.shape
(1001, 1)
>>> bool(abs(sol.energy - sol.energy[0]).max() < 1e-4)
True
"""

from . import systems
from ._ensemble import EnsembleSolution, EnsembleStatistics, Failed
from ._errors import DescriptionError, Place, Problem, StepError
from ._native import Statistics, Stepper, __version__
from ._solution import Gradient, Solution
from ._state import Quantity, State
from ._system import BoundSystem, Certificate, Jacobian, Report, System

__all__ = [
    "BoundSystem",
    "Certificate",
    "DescriptionError",
    "EnsembleSolution",
    "EnsembleStatistics",
    "Failed",
    "Gradient",
    "Jacobian",
    "Place",
    "Problem",
    "Quantity",
    "Report",
    "Solution",
    "State",
    "Statistics",
    "StepError",
    "Stepper",
    "System",
    "__version__",
    "systems",
]
