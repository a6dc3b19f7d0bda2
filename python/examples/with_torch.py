"""A run as a function of PyTorch: the same as `with_jax.py`, by `torch.autograd.Function`."""

import numpy as np
import torch

import coadjoint as co

Body = co.System(group="SO3", inertia="inertia: Vector3 [kg m²]", derivatives="parameters", name="Body")
START = {"momentum": [0.3, 2.0, 0.4]}
STEP, END = 0.05, 10.0


class Momenta(torch.autograd.Function):
    """The body's momenta after each step, as they follow from its moments of inertia."""

    @staticmethod
    def forward(ctx, inertia):
        ctx.solution = Body(inertia=inertia.detach().numpy()).run(START, END, step=STEP)
        return torch.from_numpy(np.array(ctx.solution.y.momentum))

    @staticmethod
    def backward(ctx, covectors):
        given = np.zeros_like(ctx.solution.y.flat)
        given[:, 4:7] = covectors.numpy()
        return torch.from_numpy(ctx.solution.gradient(given).parameters.flat.copy())


true = torch.tensor([1.0, 2.0, 3.0], dtype=torch.float64)
measured = Momenta.apply(true)
# nothing acts, so that the size of all moments together is the clock's: the first is known
shape = torch.tensor([1.8, 3.3], dtype=torch.float64, requires_grad=True)
optimizer = torch.optim.LBFGS([shape], max_iter=100, line_search_fn="strong_wolfe", tolerance_grad=1e-14, tolerance_change=1e-16)


def closure():
    optimizer.zero_grad()
    inertia = torch.cat([torch.ones(1, dtype=torch.float64), shape])
    loss = torch.mean((Momenta.apply(inertia) - measured) ** 2)
    loss.backward()
    return loss


optimizer.step(closure)
distance = float((shape.detach() - true[1:]).abs().max())
print(f"found {shape.detach().numpy()}: off by {distance:.1e}")
