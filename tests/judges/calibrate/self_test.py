"""Shows that the judge can fail: known-wrong answers in, each must be found; right answers must pass. Needs no vpost."""

import os
import tempfile

import numpy

import bars
import exports
import field
import judge as judging
import reference
from machine import Machine, rotation
from volume import stations, tracker, volumetric


class Fake(judging.Judge):
    """A judge whose command is played: it answers with the true machine, spoilt in one way."""

    spoil = "nothing"

    def measure(self, scenario, folder, name="measured"):
        if self.spoil == "refuse":
            return None, "", "error[VP1103]: no"
        path = os.path.join(folder, "fake.toml")
        stated = numpy.quantile(numpy.linalg.norm(self.score(scenario, path, folder), axis=1), 0.95) * {"narrow": 0.5, "wide": 2.0}.get(self.spoil, 1.0)
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"calibrated = {{ uncertainty_um = {stated:.6f} }}\n")
        off = 5.0 if self.spoil == "parameters" else 0.0
        chance = numpy.random.default_rng(abs(int(scenario.points.q.sum())))
        report = "".join(f"  {k}   {v + off + chance.normal():.4f} ± 1.96 urad\n" for k, v in scenario.values.items())
        return path, report, ""

    def score(self, scenario, profile, folder):
        machine = scenario.truth.copy()
        machine.square = machine.square + (30e-6 if self.spoil == "squareness" else 1e-7)
        if self.spoil == "play":
            machine.play = machine.play + 4e-3
        if self.spoil == "angle":
            machine.functions[machine.order[0]].append(lambda q: numpy.stack([0 * q] * 3 + [1e-7 * (q - q.mean())] * 3, axis=1))
        turn = rotation([0.02, -0.03, 0.01])[0]  # a frame is no error
        found = scenario.points.true(machine) @ turn.T + 500.0
        return field.rest(found, scenario.points.true(scenario.truth), scenario.points.group)


def main(options):
    wrong = []

    def expect(text, good):
        print(("ok    " if good else "WRONG ") + text)
        if not good:
            wrong.append(text)

    rng = numpy.random.default_rng
    with tempfile.TemporaryDirectory() as folder:
        for name, make in (
            ("volumetric, turned 50 mrad", lambda n: volumetric(rng(1), folder, "none", 0.05, n, "positions")),
            ("stations", lambda n: stations(rng(1), folder, "none", n)),
            ("tracker, own base", lambda n: tracker(rng(1), folder, "own", 0.05, n)),
            ("interferometer", lambda n: bars.interferometer(rng(1), folder, "none", n)),
            ("circles, centre off", lambda n: bars.circles(rng(1), folder, "drift", n)),
            ("table A on C", lambda n: bars.table(rng(1), folder, "drift", "AC", n)),
        ):
            quiet, loud = make(0.0).allowed_um, make(1.0).allowed_um
            expect(f"own least squares, {name}: {quiet:.4f} um without noise, {loud:.3f} um with 1 um", quiet < 0.02 and 0.1 < loud < 5)
        s = volumetric(rng(1), folder, "none", 0.0, 1.0, "deviations")
        d = s.data
        for text, read in (("as read", d["read"]), ("x and y exchanged", d["q"] + d["tool"] + (d["read"] - d["q"] - d["tool"])[:, [1, 0, 2]])):
            _, left = reference.volumetric(d["start"], d["q"], d["tool"], d["side"], d["runs"], read, 5)
            left = 1e3 * float(numpy.sqrt((left**2).mean()))
            expect(f"readings {text} leave {left:.2f} um of 1", (left < 1.1) == (text == "as read"))

    options.keep, options.count, options.match = tempfile.mkdtemp(), 12, ""
    noise = dict(judging.noise_rows())["tracker, base none, 8 mrad"]
    for spoil in ("nothing", "squareness", "play", "angle", "narrow", "wide", "parameters", "refuse"):
        fake = Fake(options)
        fake.spoil = spoil
        fake.noise_row(f"played tracker, spoilt: {spoil}", noise)
        expect(f"spoilt by {spoil}: {'passes' if spoil == 'nothing' else 'found'}", bool(fake.wrong) == (spoil != "nothing"))

    contradicted = sum(m[1] for m in judging.mistakes.MISTAKES)
    kept = judging.run
    try:
        def accepts(_, arguments, *rest):
            with open(arguments[arguments.index("-o") + 1], "w", encoding="utf-8") as file:
                file.write("\n")
            return 0, "", ""
        for text, answer, count in (("accepted", accepts, contradicted), ("refused", lambda *_: (1, "", "error[VP1101]: no"), 0)):
            judging.run = answer
            fake = Fake(options)
            fake.mistakes()
            expect(f"every mistake {text}: {fake.wrong} found wrong, {count} contradicted by the data", fake.wrong == count)
    finally:
        judging.run = kept

    run, predict = exports.run, exports.predict
    try:
        with tempfile.TemporaryDirectory() as folder:
            scenario = tracker(rng(3), folder, "none", 0.0, 1.0, play=False)
            perfect = Machine(scenario.truth.order, scenario.truth.travel)

            def uncorrected(_, arguments, *rest):
                target = str(arguments[arguments.index("-o") + 1])
                with open(target, "w", encoding="utf-8") as file:
                    file.write("uncertainty_um = 0.5\n" if target.endswith(".toml") else open(arguments[0], encoding="utf-8").read())
                return 0, "", ""

            exports.run = uncorrected
            exports.predict = lambda v, p, points, f: points.true(perfect)
            expect("an uncorrected program on a crooked machine is found", exports.closed_loop("", rng(4), folder, scenario)[0] is False)
            scenario.truth = perfect
            expect("a perfect machine needs no correction", exports.closed_loop("", rng(4), folder, scenario)[0] is True)
    finally:
        exports.run, exports.predict = run, predict
    print(f"\nself-test: {len(wrong)} wrong")
    return 1 if wrong else 0
