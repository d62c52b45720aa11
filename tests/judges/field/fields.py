"""Error fields: of a rigid three-axis machine, and such as no rigid body makes. mm in, um out; all of them infinitely smooth.

A rigid machine is (5) to (8) of docs/equations.md for the chain X, Y, Z, measured with the others at 0:
T_i(x) = q_i n_i + delta_i(q_i) + R_i x, p = T_X T_Y T_Z t, e = p - q - t.
"""

import numpy as np


def exp(v):
    """Rotation matrices (n, 3, 3) of rotation vectors (n, 3), angles below 0.1 rad."""
    k = np.zeros((len(v), 3, 3))
    k[:, 1, 0], k[:, 2, 0], k[:, 2, 1] = v[:, 2], -v[:, 1], v[:, 0]
    k -= np.transpose(k, (0, 2, 1))
    s = (v * v).sum(1)[:, None, None]
    return np.eye(3) + (1 - s / 6 + s**2 / 120) * k + (0.5 - s / 24 + s**2 / 720) * (k @ k)


def wave(rng, low, high, size):
    """A smooth function of one axis: two waves, the shorter some two thirds of the travel and more."""
    parts = [(rng.uniform(-1, 1) / n, rng.uniform(0.4, 0.8) * n * 2 * np.pi / (high - low), rng.uniform(0, 7)) for n in (1, 2)]
    slope = rng.uniform(-0.7, 0.7)
    return lambda q: size * (slope * (2 * (q - low) / (high - low) - 1) + sum(a * np.sin(w * q + f) for a, w, f in parts))


class Rigid:
    kind = "rigid"

    def __init__(self, rng, box, tool=(0, 0, 0), um=8.0, urad=20.0):
        self.tool, self.box = np.array(tool, float), box
        self.f = [[wave(rng, *box[i], um if j < 3 else urad) for j in range(6)] for i in range(3)]
        self.square = rng.uniform(-50, 50, 3)

    def six(self, i, q):
        return np.stack([f(q) for f in self.f[i]], axis=1) * np.array([1e-3] * 3 + [1e-6] * 3)

    def __call__(self, q):
        q = np.atleast_2d(np.asarray(q, float))
        ec0y, eb0z, ea0z = self.square * 1e-6
        x = np.tile(self.tool, (len(q), 1))
        for i, n in ((2, (eb0z, -ea0z, 1)), (1, (-ec0y, 1, 0)), (0, (1, 0, 0))):
            six = self.six(i, q[:, i])
            x = q[:, i : i + 1] * np.array(n, float) + six[:, :3] + np.einsum("nij,nj->ni", exp(six[:, 3:]), x)
        return 1e3 * (x - q - self.tool)

    def tables(self, nodes):
        """Nodes and rows of six, um and urad, for each axis: the profile of engine `rigid-body`."""
        return [(nodes[i], np.stack([f(nodes[i]) for f in self.f[i]], axis=1)) for i in range(3)]


class Loose:
    """Swellings, swirls and a wave that runs askew: every component a function of all three axes."""

    kind = "loose"

    def __init__(self, rng, box, um=15.0):
        low, high = np.array(box).T
        self.size = high - low
        self.low = low
        self.um = um
        self.bumps = [(rng.uniform(0.1, 0.9, 3), rng.uniform(0.22, 0.4), rng.normal(size=3)) for _ in range(4)]
        self.waves = [(rng.normal(size=3) * 2.2, rng.uniform(0, 7), rng.normal(size=3) * 0.5) for _ in range(3)]
        self.swirl = (rng.uniform(0.2, 0.8, 3), rng.normal(size=3), rng.uniform(0.3, 0.5))

    def __call__(self, q):
        u = (np.atleast_2d(np.asarray(q, float)) - self.low) / self.size
        out = np.zeros(u.shape)
        for c, w, a in self.bumps:
            out += np.exp(-0.5 * ((u - c) ** 2).sum(1) / w**2)[:, None] * a
        for k, phase, a in self.waves:
            out += np.sin(u @ k + phase)[:, None] * a
        c, axis, w = self.swirl
        out += 3 * np.cross(axis, u - c) * np.exp(-0.5 * ((u - c) ** 2).sum(1) / w**2)[:, None]
        return self.um * out


def legendre(u, degree):
    """(n, degree + 1) on -1 .. 1, each of mean square 1."""
    return np.polynomial.legendre.legvander(u, degree) * np.sqrt(2 * np.arange(degree + 1) + 1)


def smoothers(q, box):
    """The oracle's candidates: (name, penalties, solve) with solve(y, penalty) -> function of places; they differ in what they take for smooth."""
    low, high = np.array(box).T
    scaled = lambda x: 2 * (x - low) / (high - low) - 1  # noqa: E731
    u = scaled(q)
    for order in (1, 2):
        for reach in (0.5, 0.7, 1.0, 1.4, 2.0, 2.8):
            trend = lambda v, order=order: np.concatenate([np.ones((len(v), 1)), v] + ([v**2, v[:, [0]] * v[:, [1]], v[:, [1]] * v[:, [2]], v[:, [0]] * v[:, [2]]] if order == 2 else []), axis=1)  # noqa: E731
            kernel = lambda a, b, reach=reach: np.exp(-0.5 * ((a[:, None] - b[None]) ** 2).sum(2) / reach**2)  # noqa: E731
            yield f"kriging {order} {reach}", 10.0 ** np.arange(-4, 1.1, 0.5), krige(u, trend, kernel, scaled)
    for degree in range(2, 7):
        powers = [(i, j, k) for i in range(degree + 1) for j in range(degree + 1) for k in range(degree + 1) if i + j + k <= degree]
        if 2 * len(powers) < len(q):
            yield f"polynomial {degree}", (0.0,), polynomial(u, powers, degree, scaled)


def krige(u, trend, kernel, scaled):
    k, t = kernel(u, u), trend(u)

    def solve(y, penalty):
        n, m = t.shape
        a = np.block([[k + penalty * np.eye(n), t], [t.T, np.zeros((m, m))]])
        c = np.linalg.lstsq(a, np.concatenate([y, np.zeros((m, y.shape[1]))]), rcond=1e-14)[0] if penalty < 1e-8 else np.linalg.solve(a, np.concatenate([y, np.zeros((m, y.shape[1]))]))
        return lambda x: np.concatenate([kernel(scaled(x), u), trend(scaled(x))], axis=1) @ c

    return solve


def polynomial(u, powers, degree, scaled):
    def columns(v):
        p = [legendre(v[:, i], degree) for i in range(3)]
        return np.stack([p[0][:, i] * p[1][:, j] * p[2][:, k] for i, j, k in powers], axis=1)

    a = np.linalg.pinv(columns(u))

    def solve(y, _):
        c = a @ y
        return lambda x: columns(scaled(x)) @ c

    return solve


def rigid_family(q, y, box, degree):
    """The least squares of a rigid machine whose functions are polynomials: function of places."""
    low, high = np.array(box).T

    def columns(x):
        u = 2 * (x - low) / (high - low) - 1
        zero, out = np.zeros(len(x)), []
        for i in range(3):
            p = legendre(u[:, i], degree)
            arm = x.copy()
            arm[:, : i + 1] = 0
            for f in p.T:
                for j in range(3):
                    out.append(np.stack([f if c == j else zero for c in range(3)], axis=1))
                    out.append(np.cross(np.eye(3)[j], arm) * f[:, None])
        out.append(np.stack([-x[:, 1], zero, zero], axis=1))
        out.append(np.stack([x[:, 2], zero, zero], axis=1))
        out.append(np.stack([zero, -x[:, 2], zero], axis=1))
        return np.stack(out, axis=2).reshape(3 * len(x), -1)

    a = columns(q)
    size = np.linalg.norm(a, axis=0)
    size[size == 0] = 1
    c = np.linalg.lstsq(a / size, y.reshape(-1), rcond=1e-9)[0] / size
    return lambda x: (columns(x) @ c).reshape(-1, 3)


def spline(nodes, at):
    """(n, m): weights of the natural cubic spline through m nodes at places."""
    h, m = np.diff(nodes), len(nodes)
    a, b = np.eye(m), np.zeros((m, m))
    for i in range(1, m - 1):
        a[i, i - 1 : i + 2] = h[i - 1], 2 * (h[i - 1] + h[i]), h[i]
        b[i, i - 1 : i + 2] = 6 / h[i - 1], -6 / h[i - 1] - 6 / h[i], 6 / h[i]
    second = np.linalg.solve(a, b)
    k = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, m - 2)
    u, v, w, row = nodes[k + 1] - at, at - nodes[k], h[k], np.arange(len(at))
    out = np.zeros((len(at), m))
    out[row, k], out[row, k + 1] = u / w, v / w
    return out + ((u**3 / w - u * w) / 6)[:, None] * second[k] + ((v**3 / w - v * w) / 6)[:, None] * second[k + 1]


def straight(nodes, at):
    """The same of the polygon."""
    k = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
    v, row = (at - nodes[k]) / np.diff(nodes)[k], np.arange(len(at))
    out = np.zeros((len(at), len(nodes)))
    out[row, k], out[row, k + 1] = 1 - v, v
    return out


def lattice(q, y, places, weights):
    """Tensor product of one-dimensional interpolations at the places."""
    axes = [np.unique(q[:, i]) for i in range(3)]
    grid = np.zeros((*(len(a) for a in axes), 3))
    grid[tuple(np.searchsorted(a, q[:, i]) for i, a in enumerate(axes))] = y
    a, b, c = (weights(axis, places[:, i]) for i, axis in enumerate(axes))
    return np.einsum("ni,nj,nk,ijkc->nc", a, b, c, grid)


def rms(x):
    return float(np.sqrt(np.mean((x * x).sum(1))))


def best(q, y, box, places, truth, rigid):
    """(RMS at the places of the oracle smoother, its name, RMS of the true family or None), um."""
    found = (np.inf, "")
    for name, penalties, solve in smoothers(q, box):
        for penalty in penalties:
            found = min(found, (rms(solve(y, penalty)(places) - truth), f"{name} {penalty:.1e}"))
    family = min(rms(rigid_family(q, y, box, d)(places) - truth) for d in range(2, 8)) if rigid else None
    return *found, family
