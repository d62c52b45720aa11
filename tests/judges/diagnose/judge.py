#!/usr/bin/env python3
"""Outside judge of `vpost diagnose`: does it doubt itself where it should, and name what it can?

It invents machines, faults, instruments and noise (machine.py, from docs/equations.md and docs/diagnosis.md alone; shapes of its own), measures them in the
documented file format (rows.py), runs the command, and scores the answer against the truth. Families, by file:

  quiet.py     noise (no fault at all), coverage (intervals under each noise), repeats (what is no repeat)
  careful.py   harm (the written profile between the places), refuted (hold-outs that contradict)
  hidden.py    runs (effects constant within a run), outside (no effect of the library), books (bookkeeping faults)
  tools.py     stations (trackers), circles (ball bars)
  later.py     dates (has it changed?), plans (measure what was proposed), bad (input that must be refused)

Run: judge.py --vpost PATH [--only noise,harm/clusters] [--count N] [--case K] [--seed S] [--jobs J] [--minutes M] [--json FILE] [--keep DIR] [--self-test]
`--only` takes families and family/kind (the start of a kind's name does). N cases of every kind, its own number if not given. A case is decided by seed, family, kind and
number, so `--only FAMILY/KIND --case K --keep DIR` does one again and leaves its files; `--keep` keeps those of failing cases. Needs numpy.

A valid file that is refused counts against every figure of its case. Column `holds`: yes; `chance` where the figure misses what is wanted, which yet lies within the
95 % interval (Wilson) of so many cases; NO. Exit status 1 where there is a NO, 2 for the command line. What the texts leave open and the judge had to assume: README.md.
"""

import concurrent.futures
import dataclasses
import json
import os
import shutil
import sys
import tempfile
import time
import traceback
import zlib

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import folders, options  # noqa: E402  before numpy

import numpy  # noqa: E402

FAMILIES = ("noise", "coverage", "harm", "refuted", "runs", "outside", "books", "repeats", "stations", "circles", "dates", "plans", "bad")


@dataclasses.dataclass
class Kind:
    """One row of cases. `run(case)` gives Outcome; figures: name -> (least share, largest share)."""

    family: str
    name: str
    count: int
    figures: dict
    run: object


@dataclasses.dataclass
class Outcome:
    """figures: name -> (hits, of how many) or True/False; nothing under a name where the case says nothing about it."""

    figures: dict
    verdict: str
    note: str = ""


class Case:
    """What a kind needs: its random numbers, a folder, the command."""

    def __init__(self, vpost, folder, kind, number, seed):
        self.vpost, self.folder, self.number = vpost, folder, number
        self.rng = numpy.random.default_rng([seed, zlib.crc32(f"{kind.family}/{kind.name}".encode()), number])

    def path(self, name):
        return os.path.join(self.folder, name)

    def deserves(self, verdict, causes=(), **more):
        """Leaves in the folder what an answer that knows the truth would say (truth.json): for whoever looks into a failure, and for the self-test's player.
        causes: (effect, parameters[, rivals])."""
        told = {"verdict": verdict, "causes": [{"effect": c[0], "parameters": c[1], "rivals": list(c[2:3][0]) if len(c) > 2 else []} for c in causes]} | more
        with open(self.path("truth.json"), "w", encoding="utf-8") as file:
            json.dump(told, file, indent=1, default=float)


def kinds():
    import careful
    import hidden
    import later
    import quiet
    import tools
    found = [k for module in (quiet, careful, hidden, tools, later) for k in module.KINDS]
    return sorted(found, key=lambda k: FAMILIES.index(k.family))


def one(vpost, kind_at, number, seed, keep):
    """Plays one case; a dictionary of what came of it."""
    kind = kinds()[kind_at]
    folder = tempfile.mkdtemp(prefix="diagnose-judge-")
    began = time.monotonic()
    try:
        outcome = kind.run(Case(vpost, folder, kind, number, seed))
    except Exception:  # a fault of the judge, or an answer that it cannot read: never silent
        outcome = Outcome({}, "JUDGE FAILED", traceback.format_exc())
    figures = {n: (int(v), 1) if isinstance(v, (bool, numpy.bool_)) else (int(v[0]), int(v[1])) for n, v in outcome.figures.items()}
    if not figures and outcome.verdict.startswith("refused"):
        figures = {n: ((0, 1) if low > 0 else (1, 1)) for n, (low, _) in kind.figures.items()}
    fails = outcome.verdict == "JUDGE FAILED" or any(v[0] < v[1] if kind.figures[n][0] > 0 else v[0] > 0 for n, v in figures.items())
    if keep and fails:
        target = os.path.join(keep, "".join(c if c.isalnum() else "-" for c in f"{kind.family}-{kind.name}-{number}"))
        shutil.rmtree(target, ignore_errors=True)
        folders.keep(folder, target, f"{kind.family}/{kind.name}, case {number}, seed {seed}\n{outcome.verdict}\n{outcome.note}\n{figures}")
    shutil.rmtree(folder)
    return {"family": kind.family, "kind": kind.name, "case": number, "verdict": outcome.verdict, "note": outcome.note.replace(folder + os.sep, ""), "figures": figures, "fails": bool(fails),
            "seconds": round(time.monotonic() - began, 3)}


def wilson(hits, n):
    """95 % interval of a share."""
    z, p = 1.96, hits / n
    middle, half = (p + z * z / (2 * n)) / (1 + z * z / n), z / (1 + z * z / n) * numpy.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    return middle - half, middle + half


def percent(value):
    text = f"{100 * value:.1f}"
    return text[:-2] if text.endswith(".0") else text


def wanted_text(low, high):
    if low > 0 and high < 1:
        return f"{percent(low)} to {percent(high)} %"
    return f">= {percent(low)} %" if low > 0 else f"<= {percent(high)} %"


def table(chosen, cases):
    """Rows of the table: family, kind, figure, cases, share, wanted, holds."""
    rows = []
    for kind in chosen:
        mine = [c for c in cases if (c["family"], c["kind"]) == (kind.family, kind.name)]
        broken = sum(c["verdict"] == "JUDGE FAILED" for c in mine)
        for figure, (low, high) in kind.figures.items():
            pairs = [c["figures"][figure] for c in mine if figure in c["figures"]]
            hits, n = sum(p[0] for p in pairs), sum(p[1] for p in pairs)
            row = {"family": kind.family, "kind": kind.name, "figure": figure, "cases": len(mine), "hits": hits, "of": n, "wanted": wanted_text(low, high)}
            if n == 0:
                row |= {"share": None, "holds": "nothing"}
            else:
                share, (least, most) = hits / n, wilson(hits, n)
                holds = "yes" if low <= share <= high else "chance" if most >= low and least <= high else "NO"
                row |= {"share": share, "holds": "NO" if broken else holds}
            rows.append(row)
    return rows


def show(rows):
    print(f"{'family':9} {'kind':34} {'figure':36} {'cases':>5} {'found':>20} {'wanted':>12}  holds")
    for r in rows:
        found = "-" if r["share"] is None else f"{100 * r['share']:.1f} % ({r['hits']} of {r['of']})"
        print(f"{r['family']:9} {r['kind']:34} {r['figure']:36} {r['cases']:5} {found:>20} {r['wanted']:>12}  {r['holds']}")


def pick(every, only):
    """Indices of the kinds that `--only` names; a name that fits none is an error."""
    chosen = []
    for name in only.split(",") if only else FAMILIES:
        family, _, kind = name.partition("/")
        found = [k for k, one_kind in enumerate(every) if one_kind.family == family and one_kind.name.startswith(kind)]
        exact = [k for k in found if every[k].name == kind]
        found = exact or found
        if not found:
            raise SystemExit(f"--only {name}: no such family or kind; families: {', '.join(FAMILIES)}")
        chosen += [k for k in found if k not in chosen]
    return chosen


def main():
    words = options.parser(__doc__, 0, "jobs", "json", vpost="vpost")
    words.add_argument("--only", default="", help="families and kinds, by commas")
    words.add_argument("--case", type=int, default=None, help="this case alone")
    words.add_argument("--minutes", type=float, default=0, help="begin no case later than this; no limit if not given")
    words.add_argument("--list", action="store_true", help="families and kinds")
    given = words.parse_args()
    if given.self_test:
        import self_test
        return self_test.main(given.jobs)
    every = kinds()
    chosen = pick(every, given.only)
    if given.list:
        for k in chosen:
            print(f"{every[k].family}/{every[k].name}: {every[k].count} cases; " + "; ".join(f"{n} {wanted_text(*w)}" for n, w in every[k].figures.items()))
        return 0
    vpost = options.command(words, given.vpost)[0]
    if given.keep:
        os.makedirs(given.keep, exist_ok=True)
    numbers = (lambda k: [given.case]) if given.case is not None else (lambda k: range(given.count or every[k].count))
    todo = [(vpost, k, number, given.seed, given.keep) for k in chosen for number in numbers(k)]
    todo.sort(key=lambda task: task[2])  # so that every kind has its share when the time is over
    cases, began = [], time.monotonic()
    with concurrent.futures.ProcessPoolExecutor(given.jobs) as pool:
        waiting = [pool.submit(one, *task) for task in todo]
        for future in waiting:  # in order; what is begun when the time is over still ends
            if given.minutes and time.monotonic() - began > 60 * given.minutes:
                # All that wait: to cancel them one by one would wait for those that run meanwhile.
                for other in waiting:
                    other.cancel()
            if not future.cancelled():
                cases.append(future.result())
    if len(cases) < len(todo):
        print(f"{len(todo) - len(cases)} of {len(todo)} cases were not begun in {given.minutes:g} minutes\n")
    rows = table([every[k] for k in chosen], cases)
    if given.case is not None:
        for case in cases:
            print(f"{case['family']}/{case['kind']} {case['case']}: {case['verdict']} {case['figures']} {case['note']}")
        print()
    show(rows)
    failed = [c for c in cases if c["verdict"] == "JUDGE FAILED"]
    for case in failed[:3]:
        print(f"\nthe judge itself failed: {case['family']}/{case['kind']} --case {case['case']}\n{case['note']}")
    print(f"\n{len(cases)} cases; {sum(r['holds'] == 'yes' for r in rows)} of {len(rows)} figures hold, {sum(r['holds'] == 'chance' for r in rows)} miss by no more than chance")
    if given.json:
        folders.put(".", given.json, json.dumps({"seed": given.seed, "table": rows, "cases": cases}, indent=1))
    return 1 if failed or any(r["holds"] in ("NO", "nothing") for r in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
