"""The judge's own least squares: what the noise allows, what the rows can show, and the truth seen as the answer divides it.

First order about the base profile: what it leaves out are products of errors, some nanometres. With D the derivative of the tip by the six
functions of each axis and y what was read less what the base predicts, both less their means over each run:  y = D f + noise.
"""

import numpy as np

from machine import LOCATIONS, SCALE, place

STEP = 1e-5


def derivatives(machine, q, rot, tool, name):
    """(n, 3, 6): of the tip, mm, by the functions of an axis, mm and rad; and the same by its locations (tilt `axis` differs)."""
    out = []
    for kind in ("more", "located"):
        columns = []
        for j in range(6):
            step = np.zeros(6)
            step[j] = STEP
            up, down = ({name: sign * step} for sign in (1, -1))
            columns.append((machine.tip(q, rot, tool, **{kind: up}) - machine.tip(q, rot, tool, **{kind: down})) / (2 * STEP))
        out.append(np.stack(columns, axis=2))
    return out


def without_means(x, run):
    """x (n, 3, ...) less the mean of each run."""
    x = x.copy()
    for r in np.unique(run):
        x[run == r] -= x[run == r].mean(axis=0)
    return x


class Rows:
    """Places, and what was read there as a change against `base`, um, less the mean of each run."""

    def __init__(self, base, names, q, rot, tool, run, read=None, sphere=False):
        self.names, self.rot, self.run = names, rot, run
        self.by = {name: derivatives(base, q, rot, tool, name) for name in names}
        if sphere:
            self.y = without_means(-1e3 * base.tip(q, rot, tool), run)
        elif read is not None:
            self.y = without_means(read - 1e3 * base.error(q, rot, tool), run)

    def located(self):
        """(3n, 4k): by the location errors, um per um and um per urad."""
        columns = []
        for name in self.names:
            columns += [without_means(self.by[name][1][:, :, place(k)] * SCALE[place(k)] * 1e3, self.run).reshape(-1) for k in LOCATIONS[name]]
        return np.stack(columns, axis=1)

    def functions(self, bases):
        """(3n, sum): by coefficients of the functions, `bases` {name: function of degrees -> (n, m)}, six times m for each axis."""
        columns = []
        for k, name in enumerate(self.names):
            b = bases[name](self.rot[:, k])
            d = self.by[name][0] * SCALE * 1e3
            columns.append(without_means(np.einsum("ncj,nm->ncjm", d, b), self.run).reshape(3 * len(b), -1))
        return np.concatenate(columns, axis=1)


def keys(names):
    return [k for name in names for k in LOCATIONS[name]]


def fourier(degree):
    """1, cos, sin, … of degrees; and the penalty of each."""
    n = np.arange(1, degree + 1)

    def basis(at):
        a = np.radians(at)[:, None] * n
        return np.concatenate([np.ones((len(at), 1)), np.cos(a), np.sin(a)], axis=1)

    return basis, np.concatenate([[0.0], n**2.0, n**2.0])


def pieces(low, high, count):
    """Cubic B-splines on `count` equal cells; and the matrix whose square is the roughness."""
    h = (high - low) / count

    def basis(at):
        t = (np.asarray(at, float) - low) / h
        out = np.zeros((len(t), count + 3))
        cell = np.clip(np.floor(t).astype(int), 0, count - 1)
        u = t - cell
        for j, w in enumerate(((1 - u) ** 3 / 6, (3 * u**3 - 6 * u**2 + 4) / 6, (-3 * u**3 + 3 * u**2 + 3 * u + 1) / 6, u**3 / 6)):
            out[np.arange(len(t)), cell + j] = w
        return out

    return basis, np.diff(np.eye(count + 3), 2, axis=0) * count**2 / 20


def family(case, small=False):
    """Bases and penalties of all axes; `small`: of few terms."""
    bases, roughness = {}, {}
    for name in case.names:
        low, high = case.range[name]
        if high > 100:
            basis, weight = fourier(3 if small else 10)
            bases[name], roughness[name] = basis, np.diag(weight)
        else:
            bases[name], roughness[name] = pieces(low, high, 3 if small else 12)
    return bases, roughness


class Fit:
    """Penalised least squares of locations and functions; lengths and angles weigh alike at an arm of 200 mm."""

    def __init__(self, case, rows, small=False):
        self.names = case.names
        self.bases, roughness = family(case, small)
        a, b = rows.located(), rows.functions(self.bases)
        self.x, self.y = np.concatenate([a, b], axis=1), rows.y.reshape(-1)
        blocks = []
        for name in self.names:
            r = roughness[name]
            for j in range(6):
                blocks.append(r * (1.0 if j < 3 else 0.2))
        size, height = self.x.shape[1], sum(len(r) for r in blocks)
        self.rough = np.zeros((height, size))
        at, col = 0, a.shape[1]
        for r in blocks:
            self.rough[at : at + r.shape[0], col : col + r.shape[1]] = r
            at, col = at + r.shape[0], col + r.shape[1]
        self.gram, self.right = self.x.T @ self.x, self.x.T @ self.y
        # what nothing decides stays small: some 30 um a priori
        self.weak = 1e-3 * np.eye(size)

    def solve(self, penalty):
        return np.linalg.solve(self.gram + penalty * self.rough.T @ self.rough + self.weak, self.right)

    def predict(self, rows, coefficients):
        return (np.concatenate([rows.located(), rows.functions(self.bases)], axis=1) @ coefficients).reshape(-1, 3)


def rms(x):
    return float(np.sqrt(np.mean(np.sum(x * x, axis=1))))


def allowed(case, rows, unseen, wanted):
    """Least RMS at the unseen places, um, of a penalised fit that knows the truth when it chooses its penalty and nothing else."""
    best = np.inf
    x = without_means(wanted, unseen.run)
    located = rows.located()
    few, *_ = np.linalg.lstsq(located, rows.y.reshape(-1), rcond=1e-9)
    best = rms((unseen.located() @ few).reshape(-1, 3) - x)
    for small in (False, True):
        fit = Fit(case, rows, small)
        for penalty in 10.0 ** np.arange(-4, 3.1, 0.5):
            best = min(best, rms(fit.predict(unseen, fit.solve(penalty)) - x))
    return best


def saturated(case, rows):
    """Every function a number at each angle read: (matrix, angles of each axis)."""
    bases, angles = {}, {}
    for k, name in enumerate(case.names):
        angles[name] = np.unique(rows.rot[:, k])
        bases[name] = lambda at, a=angles[name]: (np.abs(at[:, None] - a) < 1e-6).astype(float)
    return np.concatenate([rows.located(), rows.functions(bases)], axis=1), angles


def sizes(names, each):
    """Natural size of each column, um: locations, then `each` {axis: numbers a function has}; an angle counts at an arm of 150 mm."""
    out = [1.0 if place(k) < 3 else 0.15 for k in keys(names)]
    for name in names if each else ():
        out += [1.0] * 3 * each[name] + [0.15] * 3 * each[name]
    return np.array(out)


def null(matrix, size, small=2e-4):
    """Columns span what the matrix does not show, or as little as products of errors do."""
    _, s, v = np.linalg.svd(matrix / size, full_matrices=True)
    rank = int((s > small * s[0]).sum())
    return v[rank:].T / size[:, None]


def open_terms(rows, names, small=1e-3):
    """Groups of location errors that the rows do not tell: [name] alone, or several that go together."""
    n = null(rows.located(), sizes(names, None), small)
    if n.shape[1] == 0:
        return []
    # reduced to rows that name as few as possible
    m, groups, row = n.T / np.abs(n).max(), [], 0
    m = m.copy()
    for col in range(m.shape[1]):
        if row == len(m):
            break
        p = row + int(np.abs(m[row:, col]).argmax())
        if abs(m[p, col]) < 1e-6:
            continue
        m[[row, p]] = m[[p, row]]
        m[row] /= m[row, col]
        for i in range(len(m)):
            if i != row:
                m[i] -= m[i, col] * m[row]
        row += 1
    for line in m[:row]:
        groups.append([k for k, v in zip(keys(names), line) if abs(v) > 1e-4 * np.abs(line).max()])
    return groups


def as_divided(case, rows, truth, answer):
    """The truth's location errors, in the answer's division between locations and tables.

    `truth`, `answer`: machines. What no reading tells apart (a mean in the table or in the location, a once-per-turn part in the table of
    one axis or in the location of another) is taken as the answer has it: the truth is moved along the null space of all readings until its
    tables are nearest to the answer's at the angles read. Returns {name: value} in um and urad.
    """
    matrix, angles = saturated(case, rows)
    n = null(matrix, sizes(case.names, {name: len(a) for name, a in angles.items()}))

    def vector(machine):
        parts = [machine.spec["rotary"][name].get("location", {}).get(k, 0.0) for name in case.names for k in LOCATIONS[name]]
        for name in case.names:
            parts.extend((machine.functions(name, angles[name]) / SCALE).T.reshape(-1))
        return np.array(parts)

    t, a = vector(truth), vector(answer)
    count = 4 * len(case.names)
    weight = sizes(case.names, {name: len(a) for name, a in angles.items()})[count:]
    g, *_ = np.linalg.lstsq(n[count:] * weight[:, None], (a - t)[count:] * weight, rcond=1e-9)
    return dict(zip(keys(case.names), (t + n @ g)[:count]))
