#!/usr/bin/env python3
"""Outside judge of `vpost calibrate`: does a measurement give the machine it measured?

It makes arbitrary smooth machines (machine.py, from the equations alone), measures them with simulated instruments in the documented
file formats (volume.py, bars.py), runs the command, and scores the written profile as a FIELD: positions by `vpost predict` against
the true machine at places spread over the volume, after the best rigid motion (field.py; exact, by singular values). Five kinds of checks:

  noise     per command and kind of base, many machines: RMS error of the field against that of the judge's own least squares on the
            same readings (reference.py), at most 1.3 times; share of printed parameters within their stated 95 % (against the
            truth where it has a definition outside the fit, else against what the command itself finds without noise); share of
            the field's points, spread over the whole travel, within `uncertainty_um`: both 92 to 97 %. A measurement that is refused counts as wrong.
  identity  a machine measured without noise from its own profile comes back to 0.1 um everywhere, for other tools and both
            directions, and so does a machine within the fit's own functions without a base; every command and chain.
  iso       coverage of the stated uncertainties of A, E, M, B of ISO 230-2.
  against   `--against` after nothing but the instrument was set up anew, and after the machine changed.
  axis      a machine comes into being axis by axis.
  mistakes  forty mistakes (mistakes.py): what is said, and none that the data contradict may pass.
  export    round trips of every form within the loss it states; loop: a user's closed loop (exports.py).

Run: judge.py --vpost PATH [--count N] [--references R] [--seconds T] [--seed S] [--only noise,mistakes] [--match TEXT] [--results FILE] [--keep DIR]
[--self-test]
N machines per row (default 5; 300 for the figures of record), fewer where a row has taken T seconds. The field is
compared with the judge's own least squares on the first R of them (default: on all), coverage is counted on all. With --results each row is
added to FILE as a line of JSON, from which page.py makes docs/calibration-benchmark.md. Needs numpy. Exit status 1 when something is wrong. Each failure
leaves its folder below --keep with `command.txt` and `found.txt`.
"""

import hashlib
import json
import os
import shlex
import shutil
import sys
import tempfile
import time
import zlib

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import folders, options  # noqa: E402  before numpy

import numpy  # noqa: E402

import bars  # noqa: E402
import exports  # noqa: E402
import field  # noqa: E402
import mistakes  # noqa: E402
from field import rest, rms, run, said  # noqa: E402
from volume import ORDERS, stations, tracker, volumetric  # noqa: E402

LIMIT, NANO = 1.3, 0.1
STEADIEST = 0.07  # scatter, from machine to machine, of the share of places within U where a field has about ten independent unknowns
FIT = ("--frame", "fit")


def noise_rows():
    """(name, maker): maker(rng, folder, order, noise factor) gives a Scenario."""
    rows = []
    for base in ("none", "own", "drift"):
        for label, turn, form in (("straight", 0.0, "deviations"), ("turned 200 urad", 2e-4, "deviations"), ("turned to 50 mrad", 0.05, "positions")):
            rows.append((f"volumetric, base {base}, {label}", lambda r, d, o, n, b=base, t=turn, f=form: volumetric(r, d, b, t, n, f, o)))
    rows.append(("volumetric, base none, straight, no play", lambda r, d, o, n: volumetric(r, d, "none", 0.0, n, "deviations", o, play=False)))
    rows.append(("volumetric, base none, smooth, 200 urad", lambda r, d, o, n: volumetric(r, d, "none", 2e-4, n, "deviations", o, nodes=7, count=110, smooth=True)))
    rows.append(("volumetric, base none, 900 mm away", lambda r, d, o, n: volumetric(r, d, "none", 0.05, n, "positions", o, shift=900.0)))
    for base in ("none", "own", "drift"):
        rows.append((f"stations, base {base}", lambda r, d, o, n, b=base: stations(r, d, b, 0.5 * n, o)))
    for base in ("none", "own", "drift"):
        for label, turn, options in (("8 mrad", 0.008, ()), ("50 mrad", 0.05, ()), ("50 mrad, --frame fit", 0.05, FIT)):
            rows.append((f"tracker, base {base}, {label}", lambda r, d, o, n, b=base, t=turn, p=options: tracker(r, d, b, t, n, o, options=p)))
    rows.append(("tracker, base none, 3 um, 16 places, fit", lambda r, d, o, n: tracker(r, d, "none", 2e-4, 3 * n, o, 16, options=FIT)))
    for base in ("none", "own", "drift"):
        rows.append((f"interferometer, base {base}", lambda r, d, o, n, b=base: bars.interferometer(r, d, b, 0.3 * n, o)))
    rows.append(("circles, base bare, on the centre", lambda r, d, o, n: bars.circles(r, d, "bare", 0.3 * n, o, off=0.0)))
    for base in ("bare", "own", "drift"):
        rows.append((f"circles, base {base}, 1 mm off", lambda r, d, o, n, b=base: bars.circles(r, d, b, 0.3 * n, o)))
    for base in ("bare", "own", "drift"):
        rows.append((f"table C on A, base {base}", lambda r, d, o, n, b=base: bars.table(r, d, b, "CA", 0.3 * n, o)))
    rows.append(("table C on A, centres 200 mm apart", lambda r, d, o, n: bars.table(r, d, "bare", "CA", 0.3 * n, o, apart=200.0)))
    for names, text in (("AC", "A on C"), ("CB", "C on B"), ("BC", "B on C")):
        rows.append((f"table {text}, base bare", lambda r, d, o, n, k=names: bars.table(r, d, "bare", k, 0.3 * n, o)))
    return rows


def identity_rows():
    rows = []
    for base in ("own", "scaled"):
        rows.append((f"volumetric, {base}, straight", lambda r, d, o, b=base: volumetric(r, d, b, 0.0, 0, "deviations", o)))
        rows.append((f"volumetric, {base}, 50 mrad", lambda r, d, o, b=base: volumetric(r, d, b, 0.05, 0, "positions", o)))
        rows.append((f"stations, {base}", lambda r, d, o, b=base: stations(r, d, b, 0, o)))
        rows.append((f"tracker, {base}, straight", lambda r, d, o, b=base: tracker(r, d, b, 0.0, 0, o)))
        rows.append((f"tracker, {base}, 50 mrad, fit", lambda r, d, o, b=base: tracker(r, d, b, 0.05, 0, o, options=FIT)))
        rows.append((f"interferometer, {base}", lambda r, d, o, b=base: bars.interferometer(r, d, b, 0, o)))
        rows.append((f"circles, {base}", lambda r, d, o, b=base: bars.circles(r, d, b, 0, o)))
    rows.append(("volumetric, own, 24 degrees", lambda r, d, o: volumetric(r, d, "warm", 0.0, 0, "deviations", o)))
    rows.append(("tracker, own, 24 degrees", lambda r, d, o: tracker(r, d, "warm", 0.0, 0, o)))
    rows.append(("interferometer, own, 24 degrees", lambda r, d, o: bars.interferometer(r, d, "warm", 0, o)))
    rows.append(("interferometer, own, EXX alone", lambda r, d, o: bars.interferometer(r, d, "own", 0, o, axes=(0,), only="X")))
    rows.append(("interferometer, own, angles of Y alone", lambda r, d, o: bars.interferometer(r, d, "own", 0, o, axes=(1,), only="ABC")))
    for names in ("CA", "AC", "CB", "BC"):
        rows.append((f"table {names}, own", lambda r, d, o, k=names: bars.table(r, d, "own", k, 0, o)))
    rows.append(("table CA, own, centres apart", lambda r, d, o: bars.table(r, d, "own", "CA", 0, o, apart=150.0)))
    # Without a base: the machine lies within the fit's functions.
    rows.append(("volumetric, none, straight, no play", lambda r, d, o: volumetric(r, d, "none", 0.0, 0, "deviations", o, play=False)))
    rows.append(("volumetric, none, 50 mrad", lambda r, d, o: volumetric(r, d, "none", 0.05, 0, "positions", o)))
    rows.append(("stations, none", lambda r, d, o: stations(r, d, "none", 0, o)))
    rows.append(("interferometer, none", lambda r, d, o: bars.interferometer(r, d, "none", 0, o)))
    rows.append(("circles, bare, 1 mm off", lambda r, d, o: bars.circles(r, d, "bare", 0, o)))
    for names in ("CA", "AC", "CB", "BC"):
        rows.append((f"table {names}, bare", lambda r, d, o, k=names: bars.table(r, d, "bare", k, 0, o)))
    return rows


class Judge:
    def __init__(self, options):
        self.options, self.vpost = options, options.vpost
        self.keep = folders.of_findings(options.keep, "calibrate-judge-")
        self.wrong, self.lines = 0, []
        self.program = {}

    def rng(self, name, number):
        return numpy.random.default_rng([self.options.seed, zlib.crc32(name.encode()), number])

    def folder(self):
        return tempfile.mkdtemp(prefix="case-", dir=self.keep)

    def fail(self, folder, name, arguments, found):
        """Keeps the reproducer of the first failure of a row under the row's name."""
        target = os.path.join(self.keep, "".join(c if c.isalnum() else "_" for c in name))
        if os.path.exists(target):
            shutil.rmtree(folder)
            return
        command = shlex.join([self.vpost, *(str(a).replace(folder + os.sep, "") for a in arguments)])
        folders.put(folder, "command.txt", command + "\n")
        folders.put(folder, "found.txt", found + "\n")
        os.rename(folder, target)

    def numbers(self, count):
        """Numbers of a row's machines: as many as were asked for, or as the row's time allows."""
        start = time.monotonic()
        for number in range(count):
            if number and self.options.seconds and time.monotonic() - start > self.options.seconds:
                return
            yield number

    def line(self, kind, name, good, text, **figures):
        self.wrong += not good
        self.lines.append((kind, good))
        if self.options.results:
            row = dict(kind=kind, name=name, holds=bool(good), **self.program, seed=self.options.seed, seconds=self.options.seconds, **figures, text=text)
            with open(self.options.results, "a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
        print(f"{'ok   ' if good else 'WRONG'} {kind:9}{name:44} {text}", flush=True)

    def wanted(self, name):
        return self.options.match in name

    def measure(self, scenario, folder, name="measured"):
        """(profile or None, report, errors): runs the command."""
        profile = os.path.join(folder, name + ".toml")
        status, out, err = run(self.vpost, [*scenario.arguments, "-o", profile])
        if status or not os.path.exists(profile):
            return None, out, err
        try:
            self.score(scenario, profile, folder)
        except RuntimeError as unusable:  # a written profile that the product itself cannot use
            return None, out, f"error[VP0000]: {unusable}"
        return profile, out, err

    def score(self, scenario, profile, folder):
        found = field.predict(self.vpost, profile, scenario.points, folder, 24 if scenario.truth.warm else None)
        return rest(found, scenario.points.true(scenario.truth), scenario.points.group)

    def noise(self):
        for name, make in noise_rows():
            if self.wanted(name):
                self.noise_row(name, make)

    def noise_row(self, name, make):
        found, own, allowed, inside, total, refused, says = [], [], [], 0, 0, 0, ""
        within, limits, shares, machines, figures = [], [], [], 0, {}
        for number in self.numbers(self.options.count):
            machines += 1
            order = ORDERS[(number + zlib.crc32(name.encode())) % 6]
            folder = self.folder()
            scenario = make(self.rng(name, number), folder, order, 1.0)
            profile, report, err = self.measure(scenario, folder)
            if profile is None:
                refused, says = refused + 1, "; ".join(said(err))[:100]
                self.fail(folder, name, scenario.arguments, "refused: " + err)
                continue
            error = self.score(scenario, profile, folder)
            found.append(rms(error))
            limited = number < (self.options.references or machines)
            if limited:
                own.append(found[-1])
                allowed.append(scenario.allowed_um)
            limit = field.stated_uncertainty(profile)
            size = numpy.linalg.norm(error, axis=1)
            if limit is not None:
                within.append((size <= limit).mean())
                limits.append(limit / numpy.quantile(size, 0.95))
            printed = field.printed(report)
            truth = {k: v for k, v in scenario.values.items() if k in printed}
            if not truth and not name.startswith("interferometer"):
                quiet = self.folder()
                clean = make(self.rng(name, number), quiet, order, 0.0)
                status, out, _ = run(self.vpost, clean.arguments)
                truth = {k: v[0] for k, v in field.printed(out).items() if k in printed and not k.startswith("closure")} if not status else {}
                shutil.rmtree(quiet)
            hits = [abs(printed[key][0] - value) <= printed[key][1] + 1e-9 for key, value in truth.items()]
            total, inside = total + len(hits), inside + sum(hits)
            if hits:
                shares.append(sum(hits) / len(hits))
            if limited and found[-1] > LIMIT * allowed[-1] * 1.5:
                self.fail(folder, name, scenario.arguments, f"field wrong by {found[-1]:.3f} um RMS, {size.max():.3f} largest; readings allow {allowed[-1]:.3f} RMS; stated uncertainty {limit}")
            else:
                shutil.rmtree(folder)
        good, text = not refused, f"refused {refused} of {machines} ({says})" if refused else ""
        if own:
            a, b = (float(numpy.sqrt(numpy.mean(numpy.square(v)))) for v in (own, allowed))
            good &= a <= LIMIT * b
            text += f" field {a:7.3f} um, allowed {b:6.3f}, ratio {a / b:6.2f}"
            figures = dict(field_um=a, allowed_um=b, references=len(allowed))
            if total:
                # Parameters of one machine hang together: the scatter from machine to machine counts too.
                share, slack = inside / total, 2.6 * max(numpy.sqrt(0.05 * 0.95 / total), numpy.std(shares) / numpy.sqrt(len(shares)))
                good &= 0.92 - slack <= share <= 0.97 + slack
                text += f"; parameters {100 * share:5.1f} % of {total}"
                figures |= dict(parameters=total, parameters_covered=share)
            if within:
                # The points of one machine hang together: machines count. Shares end at 1, so that few of them look steadier than they are.
                share, slack = float(numpy.mean(within)), 2.6 * max(numpy.std(within), STEADIEST) / numpy.sqrt(len(within))
                good &= 0.92 - slack <= share <= 0.97 + slack
                text += f"; field's points within U {100 * share:5.1f} %, U is {numpy.median(limits):.2f} of the 95 % quantile"
                figures |= dict(field_covered=share, u_over_quantile=float(numpy.median(limits)))
            else:
                good = False
                text += "; no uncertainty_um in the profile"
        self.line("noise", name, good, f"{machines} machines: {text.strip()}", machines=machines, refused=refused, **figures)

    def identity(self):
        for name, make in identity_rows():
            if not self.wanted(name):
                continue
            worst, refused, count = 0.0, [], min(6, max(2, self.options.count // 3))
            for number in range(count):
                folder = self.folder()
                scenario = make(self.rng("identity " + name, number), folder, ORDERS[(number * 5 + 1) % 6])
                profile, _, err = self.measure(scenario, folder)
                if profile is None:
                    refused.append("; ".join(said(err))[:120])
                    self.fail(folder, "identity " + name, scenario.arguments, "refused: " + err)
                    continue
                largest = float(numpy.linalg.norm(self.score(scenario, profile, folder), axis=1).max())
                worst = max(worst, largest)
                if largest > NANO:
                    self.fail(folder, "identity " + name, scenario.arguments, f"comes back wrong by {largest:.3f} um")
                else:
                    shutil.rmtree(folder)
            text = f"largest {worst:8.3f} um" + (f"; refused {len(refused)} of {count}: {refused[0]}" if refused else "")
            self.line("identity", name, worst <= NANO and not refused, text, machines=count)

    def iso(self):
        for same in (False, True):
            name = "ISO 230-2" + (", both extremes on one target" if same else "")
            if self.wanted(name):
                inside, total = iso_coverage(self, name, same)
                shares = {k: inside[k] / total[k] for k in total}
                n = max(total.values(), default=0)
                slack = 2.6 * numpy.sqrt(0.05 * 0.95 / max(n, 1))
                good = n > 0 and all(0.92 - slack <= s <= 0.97 + slack for s in shares.values())
                self.line("iso", name, good, f"{n} machines: " + ", ".join(f"{k} {100 * s:.0f} %" for k, s in shares.items()), machines=n)

    def against(self):
        makers = {"tracker": lambda r, d, t: tracker(r, d, "none", t, 0.2, count=6),
                  "volumetric": lambda r, d, t: volumetric(r, d, "none", t, 1.0, "deviations", play=False)}
        for name, make in makers.items():
            if not self.wanted("against " + name):
                continue
            said_changed, refused, count = 0, 0, 0
            for number in self.numbers(self.options.count):
                count += 1
                # The same generator for the machine, another noise and set-up: the machine draws come first.
                a, b = self.folder(), self.folder()
                first = make(self.rng(name, number), a, 1e-4 if name == "volumetric" else 0.004)
                profile, _, _ = self.measure(first, a)
                second = make(Second(self.rng(name, number), self.rng(name + " again", number), first.data), b, 2e-4 if name == "volumetric" else 0.006)
                if profile is None:
                    refused += 1
                    self.fail(a, "against " + name, first.arguments, "the first measurement was refused")
                    continue
                assert numpy.array_equal(first.points.true(first.truth), first.points.true(second.truth)), "another machine"
                status, out, err = run(self.vpost, [*second.arguments, "--against", profile])
                text = (out + err).lower()
                changed = "changed" in text and "not changed" not in text and "no change" not in text and "unchanged" not in text
                refused += bool(status)
                said_changed += changed
                if changed or status:
                    self.fail(b, "against " + name, [*second.arguments, "--against", profile], out[-600:] + err)
            self.line("against", name + ": set up anew, nothing changed", said_changed <= 0.05 * count + 1 and not refused,
                      f'"changed" {said_changed} of {count}; refused {refused}', machines=count)

    def axis(self):
        name = "one axis today, squareness tomorrow"
        if not self.wanted(name):
            return
        folder, problems, base = self.folder(), [], ["--chain"]
        scenario = bars.interferometer(self.rng(name, 0), folder, "none", 0)
        chain, profile = scenario.truth.chain(), None
        place = scenario.arguments[scenario.arguments.index("--through") + 1]
        for number, path in enumerate(scenario.data["paths"]):
            out = os.path.join(folder, f"day{number}.toml")
            arguments = ["calibrate", "interferometer", path, *(["-m", profile] if profile else ["--chain", chain]), "--through", place, "--optics", "0,0,-120", "-o", out]
            status, _, err = run(self.vpost, arguments)
            if status:
                problems.append(f"day {number + 1}: " + "; ".join(said(err))[:100])
                break
            profile = out
        circle = bars.circles(self.rng(name, 1), folder, "none", 0)
        status, _, err = run(self.vpost, [*circle.arguments, "-o", os.path.join(folder, "circles.toml")])
        if status:
            problems.append("circles from --chain: " + "; ".join(said(err))[:100])
        if problems:
            self.fail(folder, "axis by axis", ["calibrate", "interferometer", scenario.data["paths"][0], "--chain", chain, "-o", "day0.toml"], "\n".join(problems))
        self.line("axis", name, not problems, "; ".join(problems) or "written")

    def mistakes(self):
        for name, contradicted, make in mistakes.MISTAKES:
            if not self.wanted(name):
                continue
            folder = self.folder()
            arguments, evidence = make(self.rng("mistake", 0), folder)
            out = os.path.join(folder, "measured.toml")
            status, _, err = run(self.vpost, [*arguments, "-o", out])
            wrote = os.path.exists(out)
            messages = "; ".join(said(err))[:150] or "nothing said"
            good = not contradicted or (status != 0 and not wrote)
            if not good:
                self.fail(folder, "mistake " + name, arguments, f"exit {status}, profile {'written' if wrote else 'not written'}: {messages}\n{evidence}")
            state = "refused" if status else "WRITTEN" if contradicted else "written (undetectable)"
            self.line("mistake", name, good, f"{state}: {messages}" + (f" [{evidence}]" if evidence else ""))

    def export(self):
        for form in (*exports.FORMS, exports.HELD_OUT):
            for feature in exports.FEATURES if form != exports.HELD_OUT else ("positioning",):
                name = f"{form}: {feature}"
                if not self.wanted(name):
                    continue
                folder = self.folder()
                outcome, detail = exports.round_trip(self.vpost, self.rng(name, 0), folder, form, feature)
                good = outcome in ("held", "stated")
                if not good:
                    self.fail(folder, "export " + name, ["profile", "export", "machine.toml", "--format", form.split()[0].strip(","), *exports.FORMS.get(form, []), "-O", "export"], f"{outcome}: {detail}")
                self.line("export", name, good, f"{outcome}: {detail}")

    def loop(self):
        makers = {
            "volumetric": lambda r, d, o: volumetric(r, d, "none", 2e-4, 1.0, "deviations", o, play=False),
            "tracker": lambda r, d, o: tracker(r, d, "none", 0.005, 1.0, o, play=False),
            "interferometer": lambda r, d, o: bars.interferometer(r, d, "none", 0.3, o, play=False),
        }
        for kind, make in makers.items():
            name = "closed loop, " + kind
            if not self.wanted(name):
                continue
            held, machines, text = 0, 0, ""
            for number in self.numbers(self.options.count):
                machines += 1
                folder = self.folder()
                rng = self.rng(name, number)
                scenario = make(rng, folder, ORDERS[number % 6])
                if kind == "volumetric":
                    scenario.points = field.grid(scenario.truth.travel, [(0.0, 0.0, 0.0)], 5, False)
                good, detail = exports.closed_loop(self.vpost, rng, folder, scenario)
                held += good is True
                if not good:
                    text = text or detail
                    self.fail(folder, name, scenario.arguments, detail)
                else:
                    shutil.rmtree(folder)
            share, slack = held / machines, 2 * numpy.sqrt(0.05 * 0.95 / machines)
            self.line("loop", name, share >= 0.95 - slack, f"within promise {held} of {machines}" + (f"; first other: {text}" if text else ""), machines=machines, held=held)


class Second:
    """Random numbers of the same machine and another set-up: as many draws as the machine took come from the first generator.

    The makers draw machine and commands through the same calls every time; only `normal` draws of the size of readings and the set-up
    after them differ. It is enough to hand out the first generator until the set-up's first call to `normal(size=3)`.
    """

    def __init__(self, first, second, _data):
        self.first, self.second, self.setup = first, second, False

    def __getattr__(self, name):
        def call(*arguments, **options):
            if name == "normal" and options.get("size") == 3:
                self.setup = True
            return getattr(self.second if self.setup else self.first, name)(*arguments, **options)
        return call


def iso_coverage(judge, name, same):
    """Counts for A, E, M, B: truth from the noise-free means and the true standard deviation."""
    inside, total = {}, {}
    for number in judge.numbers(40 * judge.options.count):
        rng = judge.rng(name, number)
        targets, sigma = numpy.linspace(0, 400, 6), 0.8
        up = numpy.cumsum(rng.normal(size=6)) * 3
        down = up - rng.uniform(1, 4) - rng.normal(size=6) * 0.5
        if same:
            up, down = up * 0.02, up * 0.02 - 1.0
            up[2] += 4
            down[2] -= 4
        rows = []
        for k in range(1, 6):
            for sign, mean in ((1, up), (-1, down)):
                for t, m in list(zip(targets, mean))[::sign]:
                    rows.append([k, sign, t, m + rng.normal() * sigma])
        folder = judge.folder()
        path = os.path.join(folder, "x.csv")
        mistakes.save(path, "run,dir,position_mm,EXX_um", rows, 5)
        status, out, _ = run(judge.vpost, ["calibrate", "interferometer", path, "--u-um-per-m", "0"])
        shutil.rmtree(folder)
        if status:
            continue
        both = numpy.concatenate([up, down])
        truth = {"A": numpy.ptp(both) + 4 * sigma, "E": numpy.ptp(both), "M": numpy.ptp((up + down) / 2), "B": numpy.abs(up - down).max()}
        if same:
            del truth["M"]  # its extremes tie here, and a largest of equals is biased
        printed = field.printed(out)
        for key, value in truth.items():
            if key in printed:
                total[key] = total.get(key, 0) + 1
                inside[key] = inside.get(key, 0) + (abs(printed[key][0] - value) <= printed[key][1])
    return inside, total


KINDS = ("identity", "mistakes", "export", "axis", "iso", "against", "loop", "noise")


def main():
    parser = options.parser(__doc__, 5, "jobs", vpost="vpost")
    parser.add_argument("--seconds", type=float, default=0.0, help="no further machine of a row after this time; 0: all of them")
    parser.add_argument("--references", type=int, default=0, help="machines of a row that the judge fits too; 0: all of them")
    parser.add_argument("--only", default=",".join(KINDS))
    parser.add_argument("--match", default="", help="rows whose name holds this text")
    parser.add_argument("--results", help="add each row to this file as a line of JSON")
    given = parser.parse_args()
    if given.self_test:
        import self_test
        return self_test.main(given)
    judge = Judge(given)
    if given.results:
        with open(given.vpost, "rb") as file:
            judge.program["program"] = hashlib.sha256(file.read()).hexdigest()[:12]
        judge.program["version"] = run(given.vpost, ["--version"])[1].split("\n")[0]
    for kind in given.only.split(","):
        getattr(judge, kind)()
    for name in os.listdir(judge.keep):
        if name.startswith("case-"):
            shutil.rmtree(os.path.join(judge.keep, name))
    print()
    for kind in dict.fromkeys(k for k, _ in judge.lines):
        rows = [good for k, good in judge.lines if k == kind]
        print(f"{kind:9} {sum(rows)} of {len(rows)} rows hold")
    print(f"reproducers of what is wrong: {judge.keep}" if judge.wrong else "nothing wrong")
    return 1 if judge.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
