#!/usr/bin/python3
"""Exact oracles of turning: inputs, the formula, and the value, in exact rational or 50-digit arithmetic.

    /usr/bin/python3 tests/judges/turning/oracles.py            # writes oracles.json beside this file
    /usr/bin/python3 tests/judges/turning/oracles.py --check    # status 1 if the file differs from what is computed

Lengths mm, forces N, E N/mm2; results um. Each case: `id`, `inputs`, `formula` (words), `expected` (name -> um),
`tolerance_um`. Nothing of the product and nothing of workpiece.py is used: beams are closed formulas here (Young and
Budynas, Roark's Formulas, beams table, cases 1a, 1c, 1e), and integrals there.
"""

import json
import os
import sys
from decimal import Decimal, getcontext

getcontext().prec = 50
D = Decimal
PI = D("3.14159265358979323846264338327950288419716939937510")
HERE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "oracles.json")


def cosine_of_slope(rise, run):
    """cos(atan(rise / run))."""
    return run / (rise * rise + run * run).sqrt()


def inertia(diameter):
    return PI * diameter**4 / 64


def chuck(z, length, stiffness):
    """Deflection under a unit force at z from the chuck: z3 / 3EI."""
    return z**3 / (3 * stiffness)


def centres(z, length, stiffness):
    """z2 (L - z)2 / 3 EI L."""
    return z**2 * (length - z) ** 2 / (3 * stiffness * length)


def chuck_tailstock(z, length, stiffness):
    """Fixed at 0, pinned at L: z3 (L - z)2 (4L - z) / 12 EI L3."""
    return z**3 * (length - z) ** 2 * (4 * length - z) / (12 * stiffness * length**3)


def largest(function, low, high):
    """Place and value of the largest value of a function with one maximum, by golden section."""
    ratio = (D(5).sqrt() - 1) / 2
    while high - low > D("1e-18"):
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        low, high = (a, high) if function(a) < function(b) else (low, b)
    return low, function(low)


def cases():
    um = D(1000)
    radius, offset, length = D(20), D("0.025"), D(300)
    slope = offset / length
    shares = (D(0), D(75), D(150), D(225), D(300))
    yield {
        "id": "tailstock-cone",
        "inputs": {"radius_mm": radius, "tailstock_offset_um": [D(25), D(0)], "headstock_offset_um": [D(0), D(0)], "tailstock_mm": length,
                   "clamping": "centres", "z_mm": list(shares)},
        "formula": "axis from the chuck (0, 0) to the tailstock (-0.025, 300); tool tip at (R, z) of the machine: diameter error 2 ((R + 0.025 z / L) cos(atan(0.025 / L)) - R)",
        "expected": {f"diameter_error_um_at_{z}": 2 * um * ((radius + slope * z) * cosine_of_slope(offset, length) - radius) for z in shares},
        "first_order": {"diameter_error_um_at_300": D(50)},
    }
    across = D("0.025")
    yield {
        "id": "tailstock-across",
        "inputs": {"radius_mm": radius, "tailstock_offset_um": [D(0), D(25)], "headstock_offset_um": [D(0), D(0)], "tailstock_mm": length,
                   "clamping": "centres", "z_mm": [D(300)]},
        "formula": "axis from (0, 0, 0) to (0, -0.025, 300), tip at (R, 0, z): distance from a line; at z = 300: sqrt(R2 + (0.025 cos(atan(0.025 / L)))2) - R",
        "expected": {"diameter_error_um_at_300": 2 * um * ((radius**2 + (across * cosine_of_slope(across, length)) ** 2).sqrt() - radius)},
    }
    head, tail = D("-0.010"), D("0.015")
    tilt = (tail - head) / length
    yield {
        "id": "headstock-and-tailstock",
        "inputs": {"radius_mm": radius, "tailstock_offset_um": [D(15), D(0)], "headstock_offset_um": [D(-10), D(0)], "tailstock_mm": length,
                   "clamping": "centres", "z_mm": [D(0), D(120), D(300)]},
        "formula": "tg(alpha) = (dX - dX3) / L, dA = dX - z tg(alpha): diameter error 2 ((R + dA) cos(alpha) - R)",
        "expected": {f"diameter_error_um_at_{z}": 2 * um * ((radius + head + tilt * z) * cosine_of_slope(tail - head, length) - radius) for z in (D(0), D(120), D(300))},
    }
    force, stiffness = D(400), D(210000) * inertia(D(40))
    shaft = {"diameter_mm": D(40), "length_mm": length, "radial_force_n": force, "e_gpa": D(210)}
    for name, function, places in (("chuck", chuck, (100, 200, 300)), ("centres", centres, (75, 150, 225)), ("chuck-tailstock", chuck_tailstock, (75, 150, 225))):
        expected = {f"radius_error_um_at_{z}": um * force * function(D(z), length, stiffness) for z in places}
        if name == "chuck-tailstock":
            worst, value = largest(lambda z: function(z, length, stiffness), D(0), length)
            expected["largest_radius_error_um"] = um * force * value
        case = {"id": f"bending-{name}", "inputs": {**shaft, "clamping": name, "z_mm": [D(z) for z in places]}, "formula": function.__doc__.strip(), "expected": expected}
        if name == "chuck-tailstock":
            case["largest_at_mm"] = worst
        yield case
    small, large, half = D(210000) * inertia(D(30)), D(210000) * inertia(D(40)), D(150)
    full = length
    step = (half**3 / 3) / small + ((full**3 - half**3) / 3) / large
    yield {
        "id": "bending-stepped-chuck",
        "inputs": {"diameters_mm": [[D(0), D(40)], [D(150), D(40)], [D(150), D(30)], [D(300), D(30)]], "radial_force_n": force, "e_gpa": D(210), "clamping": "chuck", "z_mm": [D(300)]},
        "formula": "Castigliano: F (integral of s2 / EI over the distance s from the force), 30 mm for s < 150, 40 mm beyond",
        "expected": {"radius_error_um_at_300": um * force * step},
    }
    # Steady rest at 150 on a bar held in the chuck, force at 300: the rest's reaction X = P f(300,150) / f(150,150).
    def flexibility(a, b):
        low, high = min(a, b), max(a, b)
        return low * low * (3 * high - low) / (6 * stiffness)

    rest = D(150)
    yield {
        "id": "bending-chuck-steady",
        "inputs": {**shaft, "clamping": "chuck", "steady_mm": rest, "z_mm": [D(300)]},
        "formula": "force method on the cantilever: w = P (f(z,z) - f(z,s)2 / f(s,s)), f(a,b) = a2 (3b - a) / 6EI, a < b",
        "expected": {"radius_error_um_at_300": um * force * (flexibility(length, length) - flexibility(length, rest) ** 2 / flexibility(rest, rest))},
    }
    r, h = D(5), D("0.1")
    yield {
        "id": "tip-height",
        "inputs": {"radius_mm": r, "height_mm": h},
        "formula": "sqrt(R2 + h2) - R",
        "expected": {"radius_error_um": um * ((r * r + h * h).sqrt() - r)},
    }
    yield {
        "id": "tip-height-face",
        "inputs": {"height_mm": h},
        "formula": "a face that ends at x = 0 leaves a pip of radius |h|",
        "expected": {"pip_diameter_um": 2 * um * h},
    }
    yield {
        "id": "spindle-eccentric",
        "inputs": {"radius_mm": D(20), "EXS_cos_um": [D(5)], "EYS_sin_um": [D(5)], "angles": 720},
        "formula": "tip seen from the part: (R, 0) turned by -theta, less (e, 0): a displaced circle",
        "expected": {"roundness_least_squares_um": D(0), "roundness_minimum_zone_um": D(0), "radius_error_um": D(0), "displacement_um": D(5)},
    }
    yield {
        "id": "spindle-two-waves",
        "inputs": {"radius_mm": D(20), "EXS_cos_um": [D(0), D(3)], "angles": 720},
        "formula": "r = R - a cos(2 theta): 2a",
        "expected": {"roundness_least_squares_um": D(6), "roundness_minimum_zone_um": D(6), "radius_error_um": D(0)},
    }
    for feed, nose in ((D("0.2"), D("0.8")), (D("0.1"), D("0.4")), (D("0.3"), D("0.2"))):
        yield {
            "id": f"roughness-f{feed}-r{nose}",
            "inputs": {"feed_mm_rev": feed, "nose_radius_mm": nose},
            "formula": "r - sqrt(r2 - f2 / 4), beside f2 / 8r",
            "expected": {"rz_exact_um": um * (nose - (nose**2 - feed**2 / 4).sqrt()), "rz_parabola_um": um * feed**2 / (8 * nose)},
        }
    yield {
        "id": "squareness-FANUC0T",
        "inputs": {"EB0Z_urad": D(-80), "z_mm": D("-51.4"), "radius_mm": D("47.8")},
        "formula": "dx = EB0Z z, on the diameter twice that (first order)",
        "expected": {"diameter_error_um": 2 * um * D("-80e-6") * D("-51.4")},
    }
    lean = D("100e-6")
    norm = (1 + lean * lean).sqrt()
    yield {
        "id": "spindle-tilt",
        "inputs": {"EB0S_urad": D(100), "radius_mm": D(20), "z_mm": D(-120), "clamping": "chuck"},
        "formula": "axis through (0, 0) along (EB0S, 0, 1): diameter error 2 ((R - EB0S z) / sqrt(1 + EB0S2) - R)",
        "expected": {"diameter_error_um": 2 * um * ((radius - lean * D(-120)) / norm - radius)},
    }


def plain(value):
    if isinstance(value, Decimal):
        return float(value)
    if isinstance(value, dict):
        return {k: plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    return value


def document():
    return {"schema": "turning-oracles/1", "units": "mm, N, um; Z from the chuck unless machine coordinates are said", "cases": [{"tolerance_um": 1e-6, **plain(c)} for c in cases()]}


def main():
    text = json.dumps(document(), indent=1) + "\n"
    if "--check" in sys.argv:
        with open(HERE, encoding="ascii") as file:
            return int(file.read() != text)
    with open(HERE, "w", encoding="ascii") as out:
        out.write(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
