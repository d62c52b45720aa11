"""Feeds the judge outputs that are known to be right or wrong, worked out by hand, and tells whether it sees it."""

import numpy as np

import judge
import match
import reader
import travel
from model import Machine, Table

NONE = {None: np.zeros(3)}


def spec(tolerance=1.0, **axes):
    """A straight machine of 200 mm, with what is said of single axes and effects."""
    one = {"control": "linuxcnc", "chain": "w X Y b Z t", "cubic": False, "tool": [0, 0, 0], "offset": [0, 0, 0], "tolerance_um": tolerance,
           "effects": axes.pop("effects", []), "squareness_urad": axes.pop("squareness", [0, 0, 0]),
           "axes": [{"travel": [0, 200], "resolution": 0.001} for _ in range(3)]}
    for name, more in axes.items():
        one["axes"]["XYZ".index(name)].update(more)
    return one


def frechet(original, points):
    path = match.Pieces([m for m in reader.read(original, spec()) if m.kind != "rapid"], NONE)
    return match.distance(path, np.array(points, float), 0.005)[0] * 1e3


def dense(*corners):
    out = []
    for a, b in zip(corners, corners[1:]):
        out += [np.add(a, np.subtract(b, a) * t) for t in np.linspace(0, 1, 400)]
    return out


def ratio(machine, original, corrected, reading=None):
    found = judge.judge_text(machine, original, corrected, [0, 0, 0])
    return found[reading][0] if reading else min(r[0] for r in found.values())


def verdict(machine, original, corrected, bound, checked, passed):
    result = {"status": 0, "out": corrected, "summary": {"warnings": [], "deviation_after_um": bound},
              "check": {"passed": passed, "deviation_after_um": checked, "deviation_after_line": 1, "findings": ["x"]}}
    return {name for name, _ in judge.assess("self-test", 0, machine, original, [0, 0, 0], result)["problems"]}


def cases():
    line, there = "G0 X0 Y0 Z0\nG1 X10\n", "G0 X0 Y0 Z0\nG1 X10\nX0\n"
    corner = "G0 X0 Y0 Z0\nG1 X10\nY10\n"
    yield "nothing wrong", frechet(line, dense((0, 0, 0), (10, 0, 0))), 0, 0.03
    yield "beside", frechet(line, dense((0, 0.003, 0), (10, 0.003, 0))), 3, 0.05
    yield "going back 6 is 3 off", frechet(line, dense((0, 0, 0), (5, 0, 0), (4.994, 0, 0), (10, 0, 0))), 3, 0.05
    yield "turned 4 short", frechet(there, dense((0, 0, 0), (9.996, 0, 0), (0, 0, 0))), 4, 0.05
    yield "corner left out", frechet(corner, dense((0, 0, 0), (9.99, 0, 0), (10, 0.01, 0), (10, 10, 0))), 10 / 2**0.5, 0.05
    yield "end missed", frechet(line, dense((0, 0, 0), (9.993, 0, 0))), 7, 0.05
    arc = "G0 X0 Y0 Z0\nG2 X10 Y10 I10 J0\n"
    circle = [(10 - 10.002 * np.cos(t), 10.002 * np.sin(t), 0) for t in np.linspace(0, np.pi / 2, 60000)]
    yield "arc of another radius", frechet(arc, circle), 2, 0.05
    yield "a quarter turn about a place", frechet("G0 X0 Y0 Z0\nG68 X0 Y20 R90.\nG0 X-20 Y20 Z0\nG1 X-10 Y20\nG69\n", dense((0, 0, 0), (0, 10, 0))), 0, 0.03
    yield "the turn forgotten", frechet("G0 X0 Y0 Z0\nG68 X0 Y0 R0.02\nG1 X10\nG69\n", dense((0, 0, 0), (10, 0, 0))), 3.49, 0.05
    mirrored = [(-10 + 10 * np.cos(t), 10 * np.sin(t), 0) for t in np.linspace(0, np.pi / 2, 60000)]
    yield "a mirrored arc", frechet("G0 X0 Y0 Z0\nG51.1 X0\nG2 X10 Y10 I10 J0\nG50.1 X0\n", mirrored), 0, 0.2
    turned = [(10 * np.sin(t), 10 - 10 * np.cos(t), 0) for t in np.linspace(0, np.pi / 2, 60000)]
    yield "a turned arc", frechet("G0 X0 Y0 Z0\nG68 X0 Y0 R-90.\nG3 X-10 Y10 I-10 J0\nG69\n", turned), 0, 0.2
    tiny = "G0 X0 Y0 Z0\nG3 X0 Y0 I0.004 J0\n"
    yield "tiny circle left out", frechet(tiny, [(0, 0, 0)] * 3), 8, 0.05
    third = "G0 X0 Y0 Z0\nG18 G3 X10 Z10 Y5 I10 K0\n"
    m = reader.read(third, spec())[1]
    yield "helix in G18", abs(m.arc["sweep"]) * 2 / np.pi, 1, 1e-9
    yield "R of a large arc", abs(reader.read("G0 X0 Y0 Z0\nG2 X10 Y10 R-10\n", spec())[1].arc["sweep"]) * 2 / np.pi, 3, 1e-9
    yield "R of a small arc", abs(reader.read("G0 X0 Y0 Z0\nG3 X10 Y10 R10\n", spec())[1].arc["sweep"]) * 2 / np.pi, 1, 1e-9
    t = Table([0, 1, 2], [[0] * 6, [1] * 6, [0] * 6], True)
    yield "monotone cubic turns at its node", t.at([0.5])[0, 0], 0.75, 1e-12
    lean = Machine(spec(squareness=[100.0, 0, 0]))
    yield "squareness", lean.error([[0, 100, 0]], np.zeros((1, 3)), np.zeros((1, 3)), np.zeros(3))[0, 0] * 1e3, -10, 1e-9
    yield "play stands", travel.hysteresis([0, 1, 0.999, 0.996], [0.002] * 4, 0)[2], 0.5, 1e-9
    play = spec(X={"backlash_um": 10.0})
    good = "G0 X10.005 Y10 Z10\nG1 X50.005\nX49.995\nX19.995\nX20.005\nG1 Y20\n"
    program = "G0 X10 Y10 Z10\nG1 X50\nX20\nG1 Y20\n"
    yield "play taken up", ratio(play, program, good), 0, 0.03
    yield "play not taken up", ratio(play, program, "G0 X10.005 Y10 Z10\nG1 X50.005\nX20.005\nG1 Y20\n"), 10 / 1.866, 0.02
    yield "creep within the play", ratio(play, program, good.replace("Y20", "X20.001 Y20")), 0, 0.6
    half = "G0 X10 Y10 Z10\nG3 X10 Y30 I0 J10\n"
    yield "arc that turns inside a block", ratio(play, half, "G0 X10.005 Y10 Z10\nG3 X10.005 Y30 I0 J10\n"), 10 / 1.866, 0.05
    plunge = spec(effects=[{"id": "lost-motion.EZY", "half_width_um": 5.0}])
    source = "G0 X20 Y20 Z50\nG1 Y60\nY20\n"
    yield "sideways jump before Y turns (item 21)", ratio(plunge, source, "G0 X20 Y20 Z50.005\nG1 Y60\nZ49.995\nY20\n"), 10 / 1.866, 0.05
    yield "the same jump cannot vanish", ratio(plunge, source, "G0 X20 Y20 Z50.005\nG1 Y60\nY59.999 Z49.995\nY20\n"), 10 / 1.866, 0.1
    bow = spec(3.0, X={"errors": ([0, 16, 32], [[0, v, 0, 0, 0, 0] for v in (0.02, 0, 0.02)])})
    straight = "G0 X2 Y10 Z10\nG1 X30\n"
    yield "a bow left straight (item 20)", ratio(bow, straight, "G0 X2 Y9.9825 Z10\nG1 X30 Y9.9825\n"), 17.5 / 3.866, 0.05
    yield "the same in two lines", ratio(bow, straight, "G0 X2 Y9.9825 Z10\nG1 X16 Y10\nX30 Y9.9825\n"), 0, 0.05
    flat = spec()
    names = lambda *a: 0.0 if verdict(flat, straight, *a) else 1.0  # noqa: E731
    off = straight.replace("X30", "X30 Y10.0015")
    yield "verdict: right", names(straight, 0.1, 0.1, True), 1, 0
    yield "verdict: off by 10 um", names(straight.replace("X30", "X30.01"), 20, 20, False), 0, 0
    yield "verdict: a bound too low", names(off, 0.5, 0.5, True), 0, 0
    yield "verdict: a bound below what check finds", names(straight, 0.1, 0.3, True), 0, 0
    yield "verdict: check passes what is off", names(straight.replace("X30", "X30.01"), 20, 20, True), 0, 0
    yield "verdict: check refuses what is right", names(straight, 0.1, 0.1, False), 0, 0
    yield "verdict: a stretch missing", names("G0 X2 Y10 Z10\n", 0.1, 0.1, True), 0, 0


def run():
    failures = 0
    for name, found, expected, within in cases():
        ok = abs(found - expected) <= within
        failures += not ok
        print(f"{'ok    ' if ok else 'FAILED'} {name}: {found:.4f}, expected {expected:.4f} within {within}")
    print(f"self-test: {failures} failures")
    return 1 if failures else 0
