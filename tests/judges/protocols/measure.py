"""A measurement file: the rows of a protocol, what the instrument adds, and the columns that a shop writes."""

import math


class Measure:
    """Rows with their noise (um), offset of runs (um), turned frame (urad), display step (um) and columns."""

    def __init__(self, rows, noise, kind="vector", **how):
        self.rows, self.noise, self.kind = rows, noise, kind
        self.offset = how.get("offset", 1.0)           # standard deviation of a run's offset, in noises
        self.turn = how.get("turn", 0.0)               # standard deviation of the frame's angles, urad
        self.run_turn = how.get("run_turn", 0.0)       # the same of each run (parts clamped anew), urad
        self.step = how.get("step", 0.0)               # display step, um
        self.write_dirs = how.get("dirs", True)
        self.write_time = how.get("time", False)
        self.write_u = how.get("u", False)
        self.station = how.get("station")
        self.positions = how.get("positions", False)   # xm_mm in the place of dx_um
        self.artefact = how.get("artefact", False)
        self.flip = how.get("flip", "")                # "dirs": directions exchanged; "sign": commanded minus measured
        self.seconds = how.get("seconds", 8.0)
        self.clock()

    def clock(self):
        """Times of the rows by their order, and since their run began."""
        begun = {}
        for number, row in enumerate(self.rows):
            row.number, row.time = number, number * self.seconds
            row.run_time = row.time - begun.setdefault(row.run, row.time)

    def ray(self, row):
        """Unit vector from the fixed ball to the tip, and the nominal length, mm."""
        way = [q - b for q, b in zip(row.q, row.ball)]
        length = math.sqrt(sum(w * w for w in way))
        return [w / length for w in way], length

    def read(self, row, displacement):
        """What of a displacement the instrument shows: components, or their share along the bar, um."""
        if self.kind == "length":
            ray, _ = self.ray(row)
            return [sum(r * d for r, d in zip(ray, displacement))]
        return [displacement[k] for k in row.comps]

    def column(self, form):
        """All readings of a displacement given by row, um."""
        out = []
        for row in self.rows:
            out.extend(self.read(row, form(row)))
        return out

    def simulate(self, machine, random):
        """Readings with everything on them, by row, um."""
        frame = [random.gauss(0, self.turn) for _ in range(3)]
        own = {}
        values = []
        for row in self.rows:
            if row.run not in own:
                own[row.run] = ([random.gauss(0, self.offset * self.noise) for _ in range(3)],
                                [random.gauss(0, self.run_turn) for _ in range(3)])
            offset, angles = own[row.run]
            tip = [q + t for q, t in zip(row.q, row.tool or machine.tool)]
            turn = [frame[k] + angles[k] for k in range(3)]
            spin = [(turn[(k + 1) % 3] * tip[(k + 2) % 3] - turn[(k + 2) % 3] * tip[(k + 1) % 3]) / 1000
                    for k in range(3)]
            total = [d + o + s for d, o, s in zip(machine.displacement(row), offset, spin)]
            shown = [value + random.gauss(0, self.noise) for value in self.read(row, total)]
            if self.step:
                shown = [round(value / self.step) * self.step for value in shown]
            values.append(shown)
        return values

    def text(self, values):
        """The file, CSV."""
        head = ["run", "x_mm", "y_mm", "z_mm"]
        seen = sorted({k for row in self.rows for k in row.comps})
        if self.kind == "length":
            head += ["length_mm", "bx_mm", "by_mm", "bz_mm"]
        else:
            head += [f"{'xyz'[k]}m_mm" if self.positions else f"d{'xyz'[k]}_um" for k in seen]
        axes = [k for k in range(3) if any(row.dirs[k] for row in self.rows)] if self.write_dirs else []
        head += [f"dir_{'xyz'[k]}" for k in axes]
        if self.write_time:
            head.append("time_s")
        if self.write_u:
            head.append("u_um")
        if self.artefact:
            head.append("artefact")
        if self.station:
            head += ["station", "bx_mm", "by_mm", "bz_mm"]
        tools = any(row.tool for row in self.rows)
        if tools:
            head += ["tool_x_mm", "tool_y_mm", "tool_z_mm"]
        lines = [",".join(head)]
        for row, shown in zip(self.rows, values):
            cells = [row.run] + [f"{q:.4f}" for q in row.q] + self.shown(row, shown, seen)
            sign = -1 if self.flip == "dirs" else 1
            cells += [f"{sign * row.dirs[k]:d}" for k in axes]
            if self.write_time:
                cells.append(f"{row.time:.0f}")
            if self.write_u:
                cells.append(f"{self.noise:.3f}")
            if self.artefact:
                cells.append(row.run)
            if self.station:
                cells += ["S1"] + [f"{v:.0f}" for v in self.station]
            if tools:
                cells += [f"{t:.3f}" for t in row.tool]
            lines.append(",".join(cells))
        return "\n".join(lines) + "\n"

    def shown(self, row, shown, seen):
        """Cells of the readings."""
        if self.kind == "length":
            _, length = self.ray(row)
            return [f"{length + shown[0] / 1000:.6f}"] + [f"{b:.4f}" for b in row.ball]
        by = dict(zip(row.comps, shown))
        if self.positions:
            return [f"{row.q[k] + by[k] / 1000:.6f}" if k in by else "" for k in seen]
        sign = -1.0 if self.flip == "sign" else 1.0
        return [f"{sign * by[k]:.5f}" if k in by else "" for k in seen]
