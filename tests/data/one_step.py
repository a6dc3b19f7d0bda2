"""Single steps of the discrete equations at 50 digits, written to one_step.json.

Run: python3 -m venv v && v/bin/pip install mpmath && v/bin/python one_step.py (minutes)
Group: SO(3) semidirect k copies of R^3 as block matrices [[R, p1 .. pk], [0, I]]. Everything is taken from its definition: the
retraction tau is the power series of exp, or (I - X/2)^-1 (I + X/2); its right logarithmic derivative D tau(x)[y] tau(x)^-1 is a
central difference. With the step t and s in [0, 1]:

    m  = Ad*_{tau(-s eta)^-1} mu                       momentum at the intermediate group element
    mb = (1-s) dR tau_{(1-s) eta}^* m + s dR tau_{-s eta}^* m
    eta = t dh(mb)                                     solved by Newton
    mu' = Ad*_{tau((1-s) eta)} m,  g' = g tau(s eta) tau((1-s) eta)

h(Pi, a1, .., ak) = Pi . I^-1 Pi / 2 + sum_i (u_i + u_i^2 / 2),  u_i = a_i . chi_i.
"""
import json
import os
from mpmath import mp, mpf, matrix, eye, zeros, inverse, lu_solve

mp.dps = 50
DIFFERENCE = mpf(10) ** -18  # central differences: errors of 1e-36 from curvature, 1e-32 from rounding

INERTIA = [1.0, 2.0, 3.0]
CHI = [[0.3, 0.2, 1.0], [-0.5, 0.7, 0.1], [0.4, -0.6, 0.2]]
MOMENTUM = [0.9, -0.4, 1.2]
VECTORS = [[0.36, 0.48, 0.8], [0.8, 0.0, -0.36], [-0.5, 1.25, 0.75]]


def hat(x):
    k = len(x) // 3 - 1
    out = zeros(3 + k)
    out[0, 1], out[0, 2], out[1, 2] = -x[2], x[1], -x[0]
    out[1, 0], out[2, 0], out[2, 1] = x[2], -x[1], x[0]
    for i in range(k):
        for r in range(3):
            out[r, 3 + i] = x[3 + 3 * i + r]
    return out


def vee(m):
    out = [m[2, 1], m[0, 2], m[1, 0]]
    for i in range(m.rows - 3):
        out += [m[r, 3 + i] for r in range(3)]
    return matrix(out)


def exponential(x):
    X = hat(x)
    total, term = eye(X.rows), eye(X.rows)
    for k in range(1, 50):
        term = term * X / k
        total += term
    return total


def cayley(x):
    half, one = hat(x) / 2, eye(len(x) // 3 + 2)
    return inverse(one - half) * (one + half)


def columns(linear, n):
    out = zeros(n)
    for j in range(n):
        basis = zeros(n, 1)
        basis[j] = mpf(1)
        column = linear(basis)
        for i in range(n):
            out[i, j] = column[i]
    return out


def coadjoint(g, mu):
    g_inverse = inverse(g)
    return columns(lambda x: vee(g * hat(x) * g_inverse), len(mu)).T * mu


def right_derivative(tau, x):
    t_inverse = inverse(tau(x))

    def directional(y):
        return vee((tau(x + DIFFERENCE * y) - tau(x - DIFFERENCE * y)) / (2 * DIFFERENCE) * t_inverse)

    return columns(directional, len(x))


def velocity(mu):
    out = [mu[i] / mpf(INERTIA[i]) for i in range(3)]
    for i in range(len(mu) // 3 - 1):
        chi = [mpf(c) for c in CHI[i]]
        u = sum(mu[3 + 3 * i + r] * chi[r] for r in range(3))
        out += [c * (1 + u) for c in chi]
    return matrix(out)


def step(mu, t, tau, s):
    def intermediate(eta):
        return coadjoint(inverse(tau(-s * eta)), mu)

    def residual(eta):
        m = intermediate(eta)
        mean = (1 - s) * (right_derivative(tau, (1 - s) * eta).T * m) + s * (right_derivative(tau, -s * eta).T * m)
        return eta - t * velocity(mean)

    eta = t * velocity(mu)
    for _ in range(12):
        r = residual(eta)
        if max(abs(x) for x in r) < mpf(10) ** -25:
            break
        d = mpf(10) ** -12
        jacobian = columns(lambda e: (residual(eta + d * e) - r) / d, len(mu))
        eta -= lu_solve(jacobian, r)
    else:
        raise ArithmeticError("no convergence")
    return tau(s * eta) * tau((1 - s) * eta), coadjoint(tau((1 - s) * eta), intermediate(eta))


def main():
    cases = []
    for name, tau in [("exponential", exponential), ("cayley", cayley)]:
        for k in range(4):
            for s in [0.0, 0.3, 1.0] if k < 3 else [0.0]:
                mu = matrix([mpf(x) for x in MOMENTUM + sum(VECTORS[:k], [])])
                t = 0.5
                g, mu = step(mu, mpf(t), tau, mpf(s))
                rows = [[float(g[i, j]) for j in range(g.cols)] for i in range(g.rows)]
                cases.append({"retraction": name, "vectors": k, "s": s, "step": t, "g": rows, "mu": [float(x) for x in mu]})
                print(name, k, s)
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "one_step.json"), "w") as f:
        data = {"inertia": INERTIA, "chi": CHI, "momentum": MOMENTUM, "vectors": VECTORS, "cases": cases}
        json.dump(data, f, indent=1)


main()
