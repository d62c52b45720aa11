"""The table at the end: kinds by what went wrong, totals by variant against the limits of the issue."""

LIMITS = (("wrong", "at most", 0.01), ("harmed", "at most", 0.01), ("in set", "at least", 0.95),
          ("timid", "at most", 0.05), ("forecast", "at least", 0.90), ("hopeful", "at most", 0.0),
          ("message", "at most", 0.0), ("all-clear", "at most", 0.01))


def counts(flags):
    """(hits, asked) of an answer for each figure."""
    def asked(value):
        return (0, 0) if value is None else (int(bool(value)), 1)
    return {"wrong": (int(bool(flags["wrong"])), 1),
            "harmed": (0, 0) if flags["harm"] is None else (int(flags["harm"]["harmed"]), 1),
            "in set": asked(flags["in_set"]), "timid": asked(flags["timid"]), "forecast": asked(flags["forecast"]),
            "hopeful": asked(flags["hopeful"]), "message": (int(bool(flags["message"])), 1),
            "all-clear": (int(bool(flags["clear"])), 1)}


def add(total, more):
    for name, (hits, asked) in more.items():
        old = total.get(name, (0, 0))
        total[name] = (old[0] + hits, old[1] + asked)


def row(name, machines, total):
    cells = [f"{total.get(figure, (0, 0))[0]}/{total.get(figure, (0, 0))[1]}" for figure, _, _ in LIMITS]
    return f"{name:16s} {machines:9d} " + " ".join(f"{cell:>10s}" for cell in cells)


def show(results, variants):
    """Prints; true where a limit is missed."""
    print(f"{'kind':16s} {'machines':>9s} " + " ".join(f"{figure:>10s}" for figure, _, _ in LIMITS))
    totals, whole = {variant: {} for variant in variants}, {}
    for kind in dict.fromkeys(result["kind"] for result in results):
        mine = [result for result in results if result["kind"] == kind]
        total = {}
        for result in mine:
            for variant, flags in result["answers"].items():
                add(total, counts(flags))
                add(totals[variant], counts(flags))
                add(whole, counts(flags))
        print(row(kind, len(mine), total))
    for variant in variants:
        print(row(f"= {variant}", len(results), totals[variant]))
    print(row("= all", len(results), whole))
    missed = False
    for figure, sense, limit in LIMITS:
        hits, asked = whole.get(figure, (0, 0))
        if not asked:
            continue
        rate = hits / asked
        bad = rate > limit if sense == "at most" else rate < limit
        missed |= bad
        print(f"{figure:10s} {100 * rate:5.1f} % {sense} {100 * limit:.0f} %" + (": MISSED" if bad else ""))
    return missed
