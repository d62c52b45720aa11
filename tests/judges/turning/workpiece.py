"""A turning simulator: a tool nose against a spinning, bending workpiece. Shares no code with the product.

Frames: machine millimetres, X a radius, Z along the spindle. The tip is where `p = T_Z(z) T_X(x) t` puts it
(reference/methods.md, section 2, chain [w S b Z X t]): `T_i(q) = Trans(q n_i + d_i(q)) Rot(e_i(q))`, n_X = (1, 0, 0),
n_Z = (EB0Z, -EA0Z, 1). The part turns about a line: by the spindle alone through `centre + (EX0S, EY0S)` at machine Z 0
along (EB0S, -EA0S, 1) with headstock offset taken off; with a tailstock (`chuck-tailstock`, `centres`) from that line's
point at the chuck's face to the tailstock's point (Spirin 2012: tg(alpha) = (dX - dX3) / L, both positive where the radius
grows, hence the axis lies on the other side). The radius is the distance of the tip from that line.

README.md lists the keys and signs. Arrays: `p` n x 3 mm; angles rad.
"""

import math

import numpy as np

LINEAR = ("EX", "EY", "EZ")
ANGULAR = ("EA", "EB", "EC")


def rotation(vectors):
    """Proper rotations (Rodrigues) of rotation vectors n x 3: n x 3 x 3."""
    v = np.atleast_2d(vectors)
    angle = np.linalg.norm(v, axis=1)
    k = np.zeros((len(v), 3, 3))
    k[:, 0, 1], k[:, 0, 2], k[:, 1, 0] = -v[:, 2], v[:, 1], v[:, 2]
    k[:, 1, 2], k[:, 2, 0], k[:, 2, 1] = -v[:, 0], -v[:, 1], v[:, 0]
    a = np.sinc(angle / math.pi)[:, None, None]
    b = (0.5 * np.sinc(angle / (2 * math.pi)) ** 2)[:, None, None]
    return np.eye(3) + a * k + b * (k @ k)


class Beam:
    """A round bar of diameters along Z (linear between rows, two rows at one place are a step), by the force method."""

    def __init__(self, diameters, e_gpa, clamping, support=None, steady=None):
        self.z, self.d = np.array(diameters, float).T
        self.e = e_gpa * 1e3
        self.length = float(self.z[-1])
        self.fixed = clamping in ("chuck", "chuck-tailstock")
        self.end = support or self.length
        self.rests = ([support] if clamping == "chuck-tailstock" else []) + ([steady] if steady else [])
        self.knots = {0.0, self.length, self.end, *map(float, self.z), *self.rests}
        self.gauss = np.polynomial.legendre.leggauss(8)

    def softness(self, x):
        """1 / EI, 1/(N mm2)."""
        i = np.clip(np.searchsorted(self.z, x, side="right") - 1, 0, len(self.z) - 2)
        gap = np.where(self.z[i + 1] > self.z[i], self.z[i + 1] - self.z[i], 1.0)
        d = self.d[i] + (self.d[i + 1] - self.d[i]) * np.clip((x - self.z[i]) / gap, 0, 1)
        return 64.0 / (self.e * math.pi * d**4)

    def moment(self, at, x):
        """Moment at x of a unit force at `at` on the determinate bar (cantilever, or two pins)."""
        if self.fixed:
            return np.maximum(at - x, 0.0)
        share = 1.0 - at / self.end
        return np.where(x < at, share * x, share * x - (x - at)) * (x <= self.end)

    def integral(self, a, b):
        """Flexibility: the integral of m(a) m(b) / EI, Gauss between all kinks."""
        nodes, weights = self.gauss
        cuts = sorted({min(max(c, 0.0), self.length) for c in (*self.knots, a, b)})
        total = 0.0
        for lo, hi in zip(cuts, cuts[1:]):
            edges = np.linspace(lo, hi, 1 + max(1, int((hi - lo) / 10)))
            mid, half = (edges[:-1] + edges[1:]) / 2, (edges[1:] - edges[:-1]) / 2
            x = (mid[:, None] + half[:, None] * nodes).ravel()
            w = (half[:, None] * weights).ravel()
            total += float(np.sum(w * self.moment(a, x) * self.moment(b, x) * self.softness(x)))
        return total

    def deflection(self, at):
        """Deflection under a unit force at `at`, mm/N, at the place of the force."""
        at = float(min(max(at, 0.0), self.length))
        own = self.integral(at, at)
        if not self.rests:
            return own
        f = np.array([[self.integral(a, b) for b in self.rests] for a in self.rests])
        g = np.array([self.integral(at, a) for a in self.rests])
        return own - float(g @ np.linalg.solve(f, g))


class Lathe:
    """A lathe with its errors, from the dictionary that generate.py also writes as a profile."""

    def __init__(self, spec, perfect=False):
        self.spec = spec
        self.perfect = perfect
        self.tables = {}
        for axis in "XZ":
            table = spec["axes"][axis].get("table")
            if table and not perfect:
                at = np.array(table["position_mm"], float)
                scale = {"um": 1e-3, "urad": 1e-6}
                rows = np.zeros((len(at), 6))
                for k, name in enumerate((*LINEAR, *ANGULAR)):
                    unit = "um" if k < 3 else "urad"
                    rows[:, k] = np.array(table.get(f"{name}{axis}_{unit}", np.zeros(len(at))), float) * scale[unit]
                self.tables[axis] = (at, rows)
        square = {} if perfect else spec.get("squareness", {})
        self.n_z = np.array([square.get("EB0Z_urad", 0) * 1e-6, -square.get("EA0Z_urad", 0) * 1e-6, 1.0])
        spindle = spec.get("spindle", {})
        self.centre = np.array(spindle.get("centre_mm", [0, 0]), float)
        self.face = float(spindle.get("face_mm", 0.0))
        errors = {} if perfect else spindle
        self.waves = {name: (np.array(errors.get(f"{name}_cos_{u}", []), float), np.array(errors.get(f"{name}_sin_{u}", []), float))
                      for name, u in (("EXS", "um"), ("EYS", "um"), ("EZS", "um"), ("EAS", "urad"), ("EBS", "urad"))}
        # the line about which the part turns
        lean = np.array([errors.get("EB0S_urad", 0) * 1e-6, -errors.get("EA0S_urad", 0) * 1e-6, 1.0])
        at_zero = np.array([self.centre[0] + errors.get("EX0S_um", 0) * 1e-3, self.centre[1] + errors.get("EY0S_um", 0) * 1e-3, 0.0])
        head = np.array([0, 0] if perfect else spec.get("headstock", {}).get("offset_um", [0, 0]), float) * 1e-3
        at_face = at_zero + lean * self.face - np.array([head[0], head[1], 0.0])
        piece = {} if perfect else spec.get("workpiece", {})
        self.clamping = piece.get("clamping", "chuck")
        tail = spec.get("tailstock")
        if tail and self.clamping != "chuck" and not perfect:
            off = np.array(tail.get("offset_um", [0, 0]), float) * 1e-3
            end = np.array([self.centre[0] - off[0], self.centre[1] - off[1], self.face + tail["at_mm"]])
            lean = end - at_face
        self.origin = at_face
        self.along = lean / np.linalg.norm(lean)
        self.beam, self.force = None, 0.0
        if piece.get("radial_force_n"):
            self.force = float(piece["radial_force_n"])
            self.beam = Beam(piece["diameters_mm"], piece["e_gpa"], self.clamping, tail["at_mm"] if tail and self.clamping != "chuck" else None, piece.get("steady_mm"))
            end = self.beam.length
            self.grid = np.linspace(0, end, 1 + int(max(60, end / 2)))
            self.bent = self.force * np.array([self.beam.deflection(v) for v in self.grid])

    def bending(self, z):
        """How far the bar gives way, mm, at z from the chuck: positive, the radius grows. Cubic between 2 mm nodes."""
        if self.beam is None:
            return np.zeros_like(z)
        z = np.clip(z, 0, self.grid[-1])
        h = self.grid[1] - self.grid[0]
        i = np.clip((z / h).astype(int) - 1, 0, len(self.grid) - 4)
        t = z / h - i
        y = [self.bent[i + k] for k in range(4)]
        return (-y[0] * (t - 1) * (t - 2) * (t - 3) / 6 + y[1] * t * (t - 2) * (t - 3) / 2 - y[2] * t * (t - 1) * (t - 3) / 2 + y[3] * t * (t - 1) * (t - 2) / 6)

    def functions(self, axis, q):
        if axis not in self.tables:
            return np.zeros((len(q), 6))
        at, rows = self.tables[axis]
        return np.column_stack([np.interp(q, at, rows[:, k]) for k in range(6)])

    def tip(self, x, z, tool):
        """Where the point with tool vector `tool` (mm) is, machine frame, for axis commands x and z (radius, mm)."""
        x, z = np.asarray(x, float), np.asarray(z, float)
        fx, fz = self.functions("X", x), self.functions("Z", z)
        inner = np.einsum("nij,j->ni", rotation(fx[:, 3:]), np.asarray(tool, float)) + fx[:, :3]
        inner[:, 0] += x
        return np.einsum("nij,nj->ni", rotation(fz[:, 3:]), inner) + fz[:, :3] + z[:, None] * self.n_z

    def seen(self, p, theta=None):
        """(across in X, across in Y, along) of points from the part's axis at spindle angle theta: the sideways vector holds
        bending and the spindle's error motion; `along` is the machine Z it would have on a perfect lathe."""
        rel = p - self.origin
        # a frame carried by the axis: the machine's X made square to it
        u = self.along
        ex = np.array([1.0, 0, 0]) - u[0] * u
        ex /= np.linalg.norm(ex)
        ey = np.cross(u, ex)
        along = rel @ u
        across = rel @ ex + self.bending(along)
        side = rel @ ey
        if theta is not None:
            k = {name: series(*wave, theta) for name, wave in self.waves.items()}
            across = across - k["EXS"] * 1e-3 - k["EBS"] * 1e-6 * along
            side = side - k["EYS"] * 1e-3 + k["EAS"] * 1e-6 * along
            along = along - k["EZS"] * 1e-3
        return across, side, along + self.face

    def wobbles(self):
        return any(len(a) or len(b) for a, b in self.waves.values())


def series(cosines, sines, theta):
    """Fourier sum from the first harmonic on."""
    out = np.zeros_like(np.asarray(theta, float))
    for k, a in enumerate(cosines, 1):
        out = out + a * np.cos(k * theta)
    for k, b in enumerate(sines, 1):
        out = out + b * np.sin(k * theta)
    return out


class Nose:
    """A round nose: radius and the way from its centre to the point that the program moves, in radii (x, z)."""

    def __init__(self, radius=0.0, to_tip=(0.0, 0.0), height=0.0):
        self.radius, self.to_tip, self.height = radius, to_tip, height

    def inside(self):
        """A boring tool works towards +X."""
        return self.to_tip[0] > 0


def least_x(z, ax, az, bx, bz, radius, inside=False):
    """Envelope of a nose of that radius whose centre goes from (ax, az) to (bx, bz), at places z: the x nearest the axis that it
    reaches (farthest if inside); inf where it does not come. Shapes: z (m,), the others scalars."""
    sign = -1.0 if inside else 1.0
    ax, bx = sign * ax, sign * bx
    out = np.full(len(z), np.inf)
    for cx, cz in ((ax, az), (bx, bz)):
        near = np.abs(z - cz) <= radius
        out[near] = np.minimum(out[near], cx - np.sqrt(np.maximum(radius**2 - (z[near] - cz) ** 2, 0)))
    length = math.hypot(bx - ax, bz - az)
    if length > 0:
        tx, tz = (bx - ax) / length, (bz - az) / length
        nx, nz = -abs(tz), tx * math.copysign(1.0, tz) if tz else 0.0
        if tz:
            foot = z - radius * nz
            share = (foot - az) / (bz - az)
            on = (share >= 0) & (share <= 1)
            out[on] = np.minimum(out[on], ax + share[on] * (bx - ax) + radius * nx)
    return out if not inside else np.where(np.isinf(out), -np.inf, -out)


class Surface:
    """Radius of the finished surface at places z and spindle angles: what no nose has taken away is unknown (nan)."""

    def __init__(self, z, angles=1, inside=False):
        self.z = np.asarray(z, float)
        self.inside = inside
        self.r = np.full((angles, len(self.z)), -np.inf if inside else np.inf)

    def cut(self, lathe, nose, x, z, tool):
        """Cuts along a polyline of commands of the tip (axis commands x, z) with the tool vector from the gauge to the tip."""
        centre = np.asarray(tool, float) - np.array([nose.to_tip[0], 0, nose.to_tip[1]]) * nose.radius + np.array([0, nose.height, 0])
        p = lathe.tip(x, z, centre)
        count = len(self.r)
        for k in range(count):
            theta = None if count == 1 and not lathe.wobbles() else np.full(len(p), 2 * math.pi * k / count)
            across, side, along = lathe.seen(p, theta)
            self._sweep(k, across, side, along, nose.radius)

    def _sweep(self, k, across, side, along, radius):
        order = np.argsort(self.z)
        zs = self.z[order]
        for i in range(max(len(across) - 1, 1)):
            j = min(i + 1, len(across) - 1)
            lo = np.searchsorted(zs, min(along[i], along[j]) - radius - 1e-12)
            hi = np.searchsorted(zs, max(along[i], along[j]) + radius + 1e-12)
            if lo >= hi:
                continue
            pick = order[lo:hi]
            x = least_x(self.z[pick], across[i], along[i], across[j], along[j], radius, self.inside)
            h = 0.5 * (side[i] + side[j])
            good = np.isfinite(x)
            r = np.sqrt(np.maximum(x[good], 0.0) ** 2 + h * h)
            held = pick[good]
            self.r[k, held] = np.maximum(self.r[k, held], r) if self.inside else np.minimum(self.r[k, held], r)

    def mean(self):
        """Mean radius at each place; nan where some angle was not cut."""
        with np.errstate(invalid="ignore"):
            m = self.r.mean(axis=0)
        return np.where(np.isfinite(m), m, np.nan)


def roundness(points):
    """(least-squares, minimum-zone) roundness of points n x 2 about circles, and centre and radius of the former, mm."""
    x, y = points[:, 0], points[:, 1]
    a = np.column_stack([x, y, np.ones(len(x))])
    c = np.linalg.lstsq(a, x * x + y * y, rcond=None)[0]
    centre = c[:2] / 2
    # geometric least squares by Gauss-Newton from the algebraic one
    radius = math.sqrt(max(c[2] + centre @ centre, 0))
    for _ in range(20):
        d = points - centre
        r = np.linalg.norm(d, axis=1)
        step = np.linalg.lstsq(np.column_stack([-d / r[:, None], -np.ones(len(r))]), -(r - radius), rcond=None)[0]
        centre, radius = centre + step[:2], radius + step[2]
        if np.abs(step).max() < 1e-15:
            break
    r = np.linalg.norm(points - centre, axis=1)
    square = r.max() - r.min()
    best, at, size = square, centre.copy(), max(square, 1e-9)
    while size > 1e-12:
        moved = False
        for k in range(16):
            trial = at + size * np.array([math.cos(math.pi * k / 8), math.sin(math.pi * k / 8)])
            q = np.linalg.norm(points - trial, axis=1)
            if q.max() - q.min() < best - 1e-15:
                best, at, moved = q.max() - q.min(), trial, True
        if not moved:
            size /= 2
    return square, best, centre, radius


def section(lathe, radius, z, angles=720):
    """Points of the part (n x 2, mm) that a sharp tip left at machine Z z, commanded to that radius, turn by turn of one revolution."""
    theta = 2 * math.pi * np.arange(angles) / angles
    p = lathe.tip(np.full(angles, radius + lathe.centre[0]), np.full(angles, z), [0, 0, 0])
    across, side, _ = lathe.seen(p, theta)
    c, s = np.cos(theta), np.sin(theta)
    return np.column_stack([c * across + s * side, -s * across + c * side])


def turned(feed, nose, length, places):
    """Profile left by a nose whose centre stands every `feed` mm: x at places z, mm above the deepest."""
    x = np.full(len(places), np.inf)
    for cz in np.arange(-nose, length + nose + feed, feed):
        near = np.abs(places - cz) <= nose
        x[near] = np.minimum(x[near], nose - np.sqrt(nose**2 - (places[near] - cz) ** 2))
    return x
