"""Random lathes and their measured test pieces. A case is decided by kind, seed and number."""

import math

import numpy as np

from common.profile import Profile

from lathe import Lathe

TRAVEL = (-160.0, 720.0)
TIMED = ("drift", "drift-listed", "warming", "confounded", "confounded-listed")

# kind: (intervals are judged, what it adds)
KINDS = {
    "plain": (True, "taper, even bow, one tool, noise of its own in every row"),
    "stated": (True, "the same with u_um"),
    "quantised": (True, "a micrometer of 1 um"),
    "coarse": (True, "a micrometer of 1 um whose hand scatters less than that"),
    "edges": (True, "two or three edges of other sizes"),
    "faces": (True, "squareness of X beside the spindle's tilt"),
    "perfect": (True, "no error: nothing may be found beyond the level"),
    "bending": (True, "a bar that gives way, as the profile says"),
    "tailstock": (True, "the taper is that of the tailstock"),
    "known": (True, "a base that has tilt and straightness already, both outdated"),
    "lengths": (True, "tools with lengths: the carriage stands elsewhere"),
    "across": (True, "tilt and offset in Y, known: second order"),
    "drift": (True, "growth in time and wear that can be told apart"),
    "confounded": (True, "growth or wear, or both; time and order of the parts go together"),
    "drift-listed": (True, "drift, but the file lists the parts in another order than time_s"),
    "confounded-listed": (True, "confounded, listed in another order than time_s"),
    "shape": (False, "cubic and wavy straightness"),
    "warming": (False, "exponential growth of spindle and screw, wear"),
    "correlated": (True, "noise that hangs together along a part"),
    "clampings": (True, "each clamping a size of its own (seat, coolant)"),
    "operators": (True, "two people with two micrometers, part by part"),
    "blunder": (False, "one reading grossly wrong"),
}


class Case:
    """A machine, its rows and what is true of them."""


def polynomial(coefficients, middle, half):
    """EXZ, mm, of u = (z - middle) / half; coefficients in um, constant first."""
    def straight(z):
        u = (z - middle) / half
        return 1e-3 * sum(c * u**k for k, c in enumerate(coefficients))
    return straight


def machine(case, kind, rng):
    """Fills in the lathe and the base profile."""
    uniform = rng.uniform
    big = 0.0 if kind == "perfect" else 1.0
    numbers = {"EB0S_urad": big * uniform(-120, 120)}
    case.length = (round(uniform(5, 60), 3), round(uniform(-90, 90), 3)) if kind == "lengths" else (0.0, 0.0)
    if kind == "faces":
        numbers["EB0Z_urad"] = uniform(-60, 60)
    if kind == "across":
        numbers |= {"EA0S_urad": round(uniform(-300, 300), 3), "EY0S_um": round(uniform(-40, 40), 3), "EA0Z_urad": round(uniform(-100, 100), 3)}
    if kind == "tailstock":
        numbers = {"tailstock": {"at_mm": round(case.high + uniform(20, 80), 1), "offset_um": [uniform(-40, 40), 0.0]}}
    if kind == "bending":
        clamping = str(rng.choice(["chuck", "centres", "chuck-tailstock"]))
        bar = round(case.high + uniform(5, 40), 1)
        thick = round(uniform(45, 70) if clamping == "chuck" else uniform(30, 50), 1)
        numbers["workpiece"] = {"clamping": clamping, "radial_force_n": round(uniform(50, 300)), "diameter_mm": thick, "length_mm": bar, "e_gpa": 210.0}
        if clamping != "chuck":
            numbers["tailstock"] = {"at_mm": bar, "offset_um": [uniform(-30, 30), 0.0]}
            del numbers["EB0S_urad"]
    # where the carriage stands while it cuts
    middle, half = (case.low + case.high) / 2 + case.length[1], (case.high - case.low) / 2
    bow = big * (uniform(-12, 12) if rng.random() < 0.7 else 0.0)
    linear = big * uniform(-10, 10) if kind != "faces" else 0.0
    shape = [0.0, linear, bow]
    if kind == "shape":
        shape += [uniform(-8, 8), uniform(-4, 4)]
    straight = polynomial(shape, middle, half)
    if kind == "shape":
        waves, amplitude, phase, smooth = uniform(1, 4), uniform(0, 3), uniform(0, 6), straight
        straight = lambda z: smooth(z) + 1e-3 * amplitude * np.sin(math.pi * waves * (z - middle) / half + phase)  # noqa: E731
    case.lathe = Lathe(numbers, straight)
    case.numbers, case.shape, case.middle, case.half = numbers, shape, middle, half

    # the base profile: what the user knows
    base = {k: v for k, v in numbers.items() if k == "workpiece" or (kind == "across" and k in ("EA0S_urad", "EY0S_um", "EA0Z_urad"))}
    if "tailstock" in numbers:
        base["tailstock"] = {"at_mm": numbers["tailstock"]["at_mm"], "offset_um": [0.0, 0.0]}
    case.base_table = None
    if kind == "known":
        base["EB0S_urad"] = round(numbers["EB0S_urad"] + uniform(-60, 60), 3)
        bent = [uniform(-6, 6), uniform(-6, 6)]
        case.base_table = [(float(z), round(bent[0] * ((z - 300) / 300) ** 2 + bent[1] * (z - 300) / 300, 4)) for z in np.linspace(*TRAVEL, 33)]
    if kind == "faces" and rng.random() < 0.5:
        base["EB0Z_urad"] = round(numbers["EB0Z_urad"] + uniform(-30, 30), 3)
    case.base = base


def readings(kind, rng, error, noise, part):
    """Measured diameters, um, of what is true."""
    own = rng.normal(0, noise, len(error))
    if kind == "correlated":
        rho = rng.uniform(0.5, 0.8)
        for k in range(1, len(error)):
            own[k] = rho * own[k - 1] + math.sqrt(1 - rho**2) * own[k]
    if kind == "clampings":
        own = own + rng.normal(0, 3 * noise)
    if kind == "operators":
        own = own + (part % 2) * 2.0
    return np.round(error + own) if kind in ("quantised", "coarse") else error + own


def make(kind, seed, number):
    """The case `number` of a kind."""
    rng = np.random.default_rng([seed, number, sorted(KINDS).index(kind)])
    uniform = rng.uniform
    case = Case()
    case.number, case.timed, shuffled = number, kind in TIMED, kind.endswith("-listed")
    case.kind = kind = kind.removesuffix("-listed")
    case.low, case.high, case.noise = uniform(30, 120), uniform(260, 500), uniform(0.3, 1.5)
    if kind == "coarse":
        case.noise = uniform(0.1, 0.35)
    places, parts = int(rng.integers(4, 10)), int(rng.integers(2, 6))
    if kind in ("drift", "warming"):
        parts = int(rng.integers(6, 9))
    if kind in ("confounded", "clampings", "operators", "edges"):
        parts = int(rng.integers(4, 7))
    low, high, noise = case.low, case.high, case.noise
    machine(case, kind, rng)
    length = case.length

    edges = int(rng.integers(2, 4)) if kind == "edges" else 1
    names = [f"T{k + 1:02d}{k + 1:02d}" if kind == "lengths" else f"T{k + 1}" for k in range(edges)]
    case.sizes = {name: uniform(-15, 15) for name in names}
    case.growth = case.wear = 0.0
    if kind == "drift":
        case.growth, case.wear = uniform(-6, 6), uniform(0, 3)
    if kind == "confounded":
        which = rng.integers(3)
        case.growth = 0.0 if which == 1 else float(rng.choice([-1, 1])) * uniform(4, 12)
        case.wear = 0.0 if which == 0 else uniform(1.5, 4)
    grown = lambda h: case.growth * h  # noqa: E731
    if kind == "warming":
        limit, constant = uniform(-15, 15), uniform(0.5, 3)
        case.wear = uniform(0, 2)
        grown = lambda h: limit * (1 - np.exp(-h / constant))  # noqa: E731
    order = np.arange(parts)
    starts = order * uniform(0.3, 0.8)
    if kind in ("drift", "warming"):
        # a pause in the middle: the spindle runs on, the edge does not cut
        starts = np.sort(rng.uniform(0, 1.0, parts)) + np.where(order >= parts // 2, uniform(2, 5), 0)
    # times say in which order the parts were cut, the file need not
    listed = rng.permutation(parts) if shuffled else order
    case.rows = []
    for part in map(int, listed):
        # every test piece has its own places and size, as ISO 13041-6's collars and cylinders have
        diameter = round(uniform(30, 110), 1)
        z = np.linspace(low, high, places) + rng.uniform(-3, 3, places)
        z[0], z[-1] = low, high
        z = np.round(z, 3)
        tool = names[part] if part < edges else str(rng.choice(names))
        # the cut goes towards the chuck; the section's time is the tip's
        seconds = np.round(starts[part] * 3600 + (high - z) / uniform(1.0, 4.0), 1)
        r, _ = case.lathe.turned(diameter / 2 + length[0], z + length[1], length)
        error = 2e3 * (r - diameter / 2) + 2 * (case.sizes[tool] + grown(seconds / 3600) + case.wear * part)
        for k, value in enumerate(readings(kind, rng, error, noise, part)):
            row = {"part": f"P{part + 1}", "feature": "diameter", "z_mm": float(z[k]), "diameter_mm": diameter, "d_um": round(float(value), 2), "tool": tool}
            if case.timed:
                row["time_s"] = float(seconds[k])
            if kind == "stated":
                row["u_um"] = round(noise, 4)
            case.rows.append(row)
        if kind == "faces":
            face, count, shift = round(high + 5, 3), int(rng.integers(4, 8)), uniform(-20, 20)
            x = np.round(np.linspace(5, diameter / 2, count), 3)
            _, along = case.lathe.turned(x, np.full(count, face))
            for place, a in zip(x, along):
                case.rows.append({"part": f"P{part + 1}", "feature": "face", "z_mm": face, "diameter_mm": round(2 * float(place), 3),
                                  "d_um": round(1e3 * float(a - face) + shift + rng.normal(0, noise), 2), "tool": tool})
    if kind == "blunder":
        k = int(rng.integers(len(case.rows)))
        case.rows[k]["d_um"] = round(case.rows[k]["d_um"] + float(rng.choice([-1, 1])) * float(rng.choice([20, 50, 100, 500])), 2)
    case.parts, case.names = parts, names

    # parts that nobody fits: another size, another length; the first is shown to the command, with noise
    case.held = []
    for k in range(3):
        a, b = (low + uniform(0, 30), high - uniform(0, 60)) if k < 2 else (max(low - 25, 5), high + 15)
        case.held.append({"part": f"H{k + 1}", "diameter_mm": round(uniform(25, 115), 1), "z": np.round(np.linspace(a, b, 9), 3)})
    shown, late = case.held[0], starts[-1] + 0.5
    r, _ = case.lathe.turned(shown["diameter_mm"] / 2 + length[0], shown["z"] + length[1], length)
    error = 2e3 * (r - shown["diameter_mm"] / 2) + 2 * (case.sizes[names[0]] + grown(late) + case.wear * parts) + rng.normal(0, noise, 9)
    case.held_rows = []
    for z, value in zip(shown["z"], np.round(error) if kind in ("quantised", "coarse") else error):
        row = {"part": "H1", "feature": "diameter", "z_mm": float(z), "diameter_mm": shown["diameter_mm"], "d_um": round(float(value), 2), "tool": names[0]}
        if case.timed:
            row["time_s"] = round(float(late) * 3600, 1)
        if kind == "stated":
            row["u_um"] = round(noise, 4)
        case.held_rows.append(row)
    case.style = int(rng.integers(4))
    return case


def write_rows(path, rows, style=0):
    """CSV in one of the ways that people save it: comma; semicolon with decimal comma; tab; `feature` left out."""
    keys = list(dict.fromkeys(k for row in rows for k in row))
    if style == 3 and all(r["feature"] == "diameter" for r in rows):
        keys.remove("feature")
    separator = {1: ";", 2: "\t"}.get(style, ",")

    def text(value):
        return repr(value).replace(".", ",") if style == 1 and isinstance(value, float) else str(value)

    lines = [separator.join(keys)] + [separator.join(text(row.get(k, "")) for k in keys) for row in rows]
    with open(path, "w", encoding="cp1251", newline="") as file:
        file.write("\n".join(lines) + "\n")


def write_base(folder, case):
    """The profile as the user has it: lathe.toml, with a table beside it where there is one."""
    base = case.base
    p = Profile("judged", "fanuc-lathe", "[w S b Z X t]")
    p[""]["calibrated"] = {"temperature_c": 20.0, "uncertainty_um": 1.0, "date": "2026-01-01", "instrument": "none"}
    p["program"].update(g_code_system="A", x="diameter", decimal="millimetres")
    for axis, travel in (("X", [-20, 260]), ("Z", TRAVEL)):
        p.axis(axis).update(travel_mm=travel, resolution_mm=0.001)
    if case.base_table:
        p.errors("Z", *zip(*((z, [v]) for z, v in case.base_table)), columns=["EXZ_um"])
    p["work_offsets_mm"]["G54"] = [0, 0, 0]
    p["squareness"].update({k: base[k] for k in ("EB0Z_urad", "EA0Z_urad") if k in base})
    p["spindle"].update({k: base[k] for k in ("EX0S_um", "EY0S_um", "EA0S_urad", "EB0S_urad") if k in base})
    if any(case.length):
        p["tool"]["lengths_mm"] = {"H1": [case.length[0], 0, case.length[1]]}
    if "tailstock" in base:
        p["tailstock"].update(at_mm=base["tailstock"]["at_mm"], offset_um=[0, 0])
    if "workpiece" in base:
        w = base["workpiece"]
        p["workpiece"].update(diameters_mm=[[0, w["diameter_mm"]], [w["length_mm"], w["diameter_mm"]]], e_gpa=w["e_gpa"])
        p["workpiece"].update(clamping=w["clamping"], radial_force_n=w["radial_force_n"])
    p.write(folder, "lathe.toml")
