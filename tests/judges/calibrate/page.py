#!/usr/bin/env python3
"""docs/calibration-benchmark.md from what the judge has found: page.py RESULTS.jsonl > docs/calibration-benchmark.md

RESULTS are lines of `judge.py --results`, all of one build; a row judged twice counts as it was judged last.
"""

import json
import re
import sys

import judge

HEAD = """# Machines measured and found again

What `vpost calibrate` makes of machines whose truth is known, as an outside judge sees it (`tests/judges/calibrate`, Python, no code in common with vpost):

```console
cargo build --release -p vpost
python3 tests/judges/calibrate/judge.py --vpost target/release/vpost --count 300 --results results.jsonl{options}
python3 tests/judges/calibrate/page.py results.jsonl > docs/calibration-benchmark.md
```

{version}, seed {seed}. The judge's machines are smooth functions of every axis with constant angles, play, squareness and lines measured anywhere, in
every order of the axes, written down from [equations.md](equations.md) (5) to (9); instruments are turned by up to 50 mrad and stand anywhere. The profile that is written is
scored as a field: `vpost predict` against the truth at places all over the travel, with both directions and every tool measured, each set-up's best rigid motion taken off.
"""

NOISE = """## With noise

Field: RMS error of the profile, and what the judge's own least squares of the same readings leaves{references}; at most 1.3 times that is wanted. Parameters: share of what is
printed with ± that holds the truth. Places: share of the volume's places whose error is within the profile's `uncertainty_um`. 92 to 97 % of both are wanted, a row fails where it is
outside by more than 2.6 standard deviations of that share from machine to machine. Base: none (the chain alone), bare (a profile without tables), own (the machine's own profile: nothing
has changed), drift (a profile, and the machine has changed since).
"""


def number(value, digits):
    return "–" if value is None else f"{value:.{digits}f}"


def percent(value):
    return "–" if value is None else f"{100 * value:.1f}"


def table(head, rows):
    lines = ["| " + " | ".join(cells) + " |" for cells in (head, ["---"] * len(head), *rows)]
    return "\n".join(lines) + "\n"


def plain(text):
    """Fit for a cell; the judge's words have um for µm."""
    text = re.sub(r"\bum\b", "µm", re.sub(r"\burad\b", "µrad", " ".join(text.split())))
    return re.sub(r"\S*/case-[^/ ]+/", "", text).replace("|", "\\|")  # the judge's folders are nobody's


def split(name):
    """(command and instrument, base) of a row's name."""
    parts = name.split(", ")
    base = next((p[5:] for p in parts if p.startswith("base ")), "bare" if name.startswith("table") else "none")
    return ", ".join(p for p in parts if not p.startswith("base ")), base


def read(path):
    rows = {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            row = json.loads(line)
            rows.pop((row["kind"], row["name"]), None)
            rows[row["kind"], row["name"]] = row
    return rows


def noise_table(rows):
    lines = []
    for (kind, name), row in rows.items():
        if kind != "noise":
            continue
        what, base = split(name)
        a, b = row.get("field_um"), row.get("allowed_um")
        ratio = None if not b else a / b
        cells = [what, base, str(row["machines"]), number(a, 3), number(b, 3), number(ratio, 2), percent(row.get("parameters_covered")), percent(row.get("field_covered"))]
        lines.append([*cells, "yes" if row["holds"] else "**no**"])
    return table(["measured", "base", "machines", "field, µm", "allowed, µm", "ratio", "parameters, %", "places, %", "holds"], lines)


def main():
    rows = read(sys.argv[1])
    if len({(row["program"], row["seed"]) for row in rows.values()}) > 1:
        sys.exit("the results are of several builds or seeds: judge them with one")
    one = next(iter(rows.values()))
    kinds = {kind: [row for row in rows.values() if row["kind"] == kind] for kind in dict.fromkeys(k for k, _ in rows)}
    seconds = sorted({row["seconds"] for row in rows.values() if row.get("seconds")})
    limit = f" --seconds {seconds[-1]:g}" if seconds else ""
    print(HEAD.format(options=limit, version=one["version"], seed=one["seed"]))
    if seconds:
        print("No row took a further machine after its time (`--seconds`), so most have fewer than 300.\n")
    counts = [[kind, str(sum(row["holds"] for row in own)), str(len(own))] for kind, own in kinds.items()]
    print(table(["kind", "rows that hold", "of"], counts))
    wrong = [row for row in rows.values() if not row["holds"]]
    print("Short of it: " + "; ".join(f"{row['kind']}, {row['name']} ({plain(row['text'])})" for row in wrong) + ".\n" if wrong else "Every row holds.\n")
    missing = [kind for kind in judge.KINDS if kind.removesuffix("s") not in kinds and kind not in kinds]
    missing += [name for name, _ in judge.noise_rows() if ("noise", name) not in rows]
    if missing:
        print("Not judged this time: " + "; ".join(missing) + ".\n")
    if "noise" in kinds:
        most = max(row["machines"] for row in kinds["noise"])
        fitted = max(row.get("references", row["machines"]) for row in kinds["noise"])
        print(NOISE.format(references=f" (compared on the first {fitted} machines of a row)" if fitted < most else ""))
        print(noise_table(rows))
    sections = (
        ("identity", "## Without noise", "Measured from its own profile a machine comes back, whatever was measured and in every chain, to 0.1 µm; so does one within the fit's own functions without a base.", "largest error"),
        ("loop", "## The loop of a user", "Measured, profile written, program corrected at 1 µm; the corrected program runs on the true machine. Promise: path within tolerance, rounding of the output and `uncertainty_um`.", "found"),
        ("against", "## `--against`", "The same machine, the instrument set up anew: the profile must not say that the machine has changed, but once in twenty.", "found"),
        ("iso", "## ISO 230-2", "Share of machines whose A, E, M, B lie within their stated uncertainty; truth from the means and the standard deviation without noise.", "found"),
        ("axis", "## Axis by axis", "X, then Y, then Z by interferometer, each day from the profile of the day before; circles from the chain alone.", "found"),
        ("mistake", "## Mistakes", "What is said of each. None that the readings contradict may give a profile; the others cannot be seen in them.", "said"),
        ("export", "## Exports read back", "Held: the file read back gives the field to 0.1 µm. Stated: the export's warning names what the form cannot hold.", "found"),
    )
    for kind, title, text, column in sections:
        if kind in kinds:
            print(title + "\n\n" + text + "\n")
            print(table(["row", column, "holds"], [[plain(row["name"]), plain(row["text"]), "yes" if row["holds"] else "**no**"] for row in kinds[kind]]))


if __name__ == "__main__":
    main()
