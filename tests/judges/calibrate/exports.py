"""Round trips of `profile export`, and the closed loop of a user.

Export: a machine with one feature more than positioning, on nodes that the form can hold; where the warning VP1112 does not
name the feature as lost, the file read back has to give the same field (0.1 um after the best frame).

Closed loop: measured by an instrument, profile, program corrected; the corrected program then runs on the generator's
machine (not on the profile), and the path of its tool, in the frame in which profile and truth agree best, must stay
within tolerance + output rounding + the profile's stated uncertainty of the programmed path.
"""

import os
import re

import numpy

from field import frame, grid, predict, rest, run, said, stated_uncertainty
from machine import AXES, Machine, Smooth, tabled, write_profile

FEATURES = {
    "positioning": "positioning",
    "straightness": "straightness",
    "angles": "angles",
    "squareness": "squareness",
    "play": "direction",
    "measured lines": "measured",
    "default tool": r"(?<!other )tools?\b(?! than the default)",
    "scale effect": "effect",
    "monotone": "interpolation|monotone",
}
FORMS = {"linuxcnc": [], "isg": [], "csv": [], "lattice": [], "lattice corrections": ["--lattice", "corrections"]}
# Read back as a user would, with the command's own hold-out: lines of five points lose the same fifth every time.
HELD_OUT = "lattice, default hold-out"


def featured(rng, feature, form):
    """A machine of 200 mm with 5 nodes an axis; the lattice's step is that of the nodes."""
    machine = Machine((0, 1, 2), [(0, 200), (-100, 100), (-250, -50)])
    rich = feature not in ("positioning", "straightness", "squareness", "play", "scale effect", "monotone")
    for axis in range(3):
        machine.functions[axis] = [Smooth(rng, *machine.travel[axis], 8, 25, 30)]
    machine = tabled(machine, 5)
    for axis in range(3):
        values = machine.functions[axis][0].values
        if not rich:
            values[:, 3:] = 0
        if not rich and feature != "straightness":
            values[:, [k for k in range(3) if k != axis]] = 0
        if feature == "measured lines":
            machine.measured[axis] = {AXES[k]: float(numpy.mean(machine.travel[k])) + 30.0 for k in range(3) if k != axis}
    if feature == "squareness":
        machine.square = numpy.array([40e-6, -30e-6, 20e-6])
    if feature == "play":
        machine.play = numpy.array([4e-3, 6e-3, 2e-3])
    if feature == "default tool":
        machine.tool = numpy.array([20.0, -10.0, -120.0])
    if feature == "scale effect":
        machine.scale = numpy.array([50e-6, -30e-6, 20e-6])
    return machine


def round_trip(vpost, rng, folder, form, feature):
    """(outcome, detail): "stated" (the warning names the loss), "held", "WRONG" or "REFUSED"."""
    machine = featured(rng, feature, form)
    profile = write_profile(machine, folder, "machine", interpolation="monotone" if feature == "monotone" else None)
    out = os.path.join(folder, "export")
    status, _, err = run(vpost, ["profile", "export", profile, "--format", form.split()[0].strip(","), "-O", out, *FORMS.get(form, [])])
    if status:
        return "REFUSED", "export: " + "; ".join(said(err))
    warning = " ".join(re.findall(r"VP1112\]: (.*)", err))
    lost = bool(re.search(FEATURES[feature], warning))
    needs = feature in ("measured lines", "default tool") and "angles" in warning
    if lost or needs:
        return "stated", warning[:90]
    files = sorted(os.path.join(out, name) for name in os.listdir(out))
    chain = ["--chain", machine.chain()]
    c, b, a = machine.square * 1e6
    square = ["--squareness", f"XY={c:g},ZX={b:g},YZ={a:g}", "--squareness-convention", "right-handed", "--straightness-slopes", "keep"]
    if form == "linuxcnc":
        files = [f"{path}=E{letter}{letter}:mm" for path in files for letter in [os.path.basename(path)[0].upper()]]
        arguments = ["interferometer", *files, "--values", "positions", *chain, *square]
    elif form == "isg":
        arguments = ["interferometer", *files, "--reference", "line", "--values", "errors", "--squareness-convention", "right-handed",
                     "--straightness-slopes", "keep", *chain]
    elif form == "csv":
        arguments = ["interferometer", *files, *chain, *square]
    else:
        arguments = ["volumetric", *files, "--nodes", "5", *([] if form == HELD_OUT else ["--holdout-every", "0"]), *chain]
    back = os.path.join(folder, "back.toml")
    status, _, err = run(vpost, ["calibrate", *arguments, "-o", back])
    if status:
        return "REFUSED", "import: " + "; ".join(said(err))[:200]
    points = grid(machine.travel, [machine.tool], 9, feature == "play")
    true = predict(vpost, profile, points, folder)
    error = rest(predict(vpost, back, points, folder), true, points.group)
    worst = numpy.linalg.norm(error, axis=1).max()
    return ("held" if worst <= 0.1 else "WRONG"), f"largest {worst:.3f} um after the best frame; stated loss: {warning[:120] or 'none'}"


def program(rng, travel, tool, count=12):
    """(text, tip's corner points) of a program of straight feeds within nine tenths of the travel, with a tool length."""
    low, high = (numpy.array([t[k] for t in travel]) for k in range(2))
    corners = numpy.round(rng.uniform(low + 0.05 * (high - low), high - 0.05 * (high - low), (count, 3)), 3) + tool
    text = ["G21", "G90", "G17", "G54"] + (["G43 H1"] if tool[2] else [])
    text += ["G0 X{:.3f} Y{:.3f} Z{:.3f}".format(*corners[0]), "G1 X{:.3f} Y{:.3f} Z{:.3f} F600".format(*corners[1])]
    text += ["X{:.3f} Y{:.3f} Z{:.3f}".format(*c) for c in corners[2:]]
    return "\n".join(text + ["M2"]) + "\n", corners


def moves(text):
    """Words X Y Z of a program of straight motions, feeds only: (n, 2, 3)."""
    at, mode, found = numpy.full(3, numpy.nan), None, []
    for line in text.split("\n"):
        line = re.sub(r"\(.*?\)|;.*", "", line).upper()
        words = re.findall(r"([A-Z])\s*([-+]?[0-9]*\.?[0-9]+)", line)
        for letter, value in words:
            if letter == "G" and float(value) in (0, 1):
                mode = int(float(value))
            elif letter == "G" and float(value) not in (21, 90, 17, 54, 43):
                raise ValueError("the judge does not read " + line)
        target = at.copy()
        for letter, value in words:
            if letter in AXES:
                target[AXES.index(letter)] = float(value)
        if any(letter in AXES for letter, _ in words):
            if mode == 1:
                found.append((at, target))
            at = target
    return numpy.array(found)


def distance(points, corners):
    """Of each point to the polyline through the corners."""
    best = numpy.full(len(points), numpy.inf)
    for a, b in zip(corners, corners[1:]):
        t = numpy.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        best = numpy.minimum(best, numpy.linalg.norm(points - a - t[:, None] * (b - a), axis=1))
    return best


def closed_loop(vpost, rng, folder, scenario, tolerance=1.0):
    """(True, False or None where something was refused; text) for one user."""
    profile = os.path.join(folder, "measured.toml")
    status, _, err = run(vpost, [*scenario.arguments, "-o", profile])
    if status:
        return None, "calibrate refused: " + "; ".join(said(err))[:160]
    uncertainty = stated_uncertainty(profile)
    tool = scenario.points.tool[0]
    text, corners = program(rng, scenario.truth.travel, tool)
    source, target = os.path.join(folder, "in.ngc"), os.path.join(folder, "out.ngc")
    with open(source, "w", encoding="utf-8") as file:
        file.write(text)
    arguments = [source, "-m", profile, "--zero", "true", "-d", "linuxcnc", "--work-offset", "G54=0,0,0", "--tolerance", tolerance,
                 "--start-at=" + ",".join(f"{v:g}" for v in corners[0] - tool)]
    status, _, err = run(vpost, [*arguments, *(["--tool", f"H1={-tool[2]:g}"] if tool[2] else []), "-o", target])
    if status:
        return None, "correction refused: " + "; ".join(said(err))[:160]
    points = scenario.points
    r, s = frame(points.true(scenario.truth), predict(vpost, profile, points, folder))
    with open(target, encoding="utf-8") as file:
        pairs = moves(file.read())
    share = numpy.linspace(0, 1, 25)
    tips = (pairs[:, 0, None] + share[None, :, None] * (pairs[:, 1] - pairs[:, 0])[:, None]).reshape(-1, 3)
    deviation = distance(scenario.truth.position(tips - tool, tool) @ r.T + s, corners) * 1e3
    limit = tolerance + 0.5 * numpy.sqrt(3) + (uncertainty or 0.0)
    worst = float(deviation.max())
    return bool(worst <= limit), f"path off by {worst:.2f} um, promised {tolerance:g} + 0.87 + {uncertainty} um"
