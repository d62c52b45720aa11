"""Does the judge see damage? Right outputs are spoiled one by one: a word moved by 0.05 mm, a line lost, a code changed.

    python3 judge.py --vpost target/release/vpost --count 20 --self-test

Damage that changes no motion (a word that repeats where the axis stands, a comment) is known by the interpreter: both
texts are then the same program to it, and it is counted apart.
"""

import collections
import random
import re

import compare
import judge
import readers
from core import Invalid


def spoil(rng, text):
    """(what was done, the text)."""
    lines = text.split("\n")
    body = [i for i, line in enumerate(lines) if re.match(r"(N\d+)?\s*[GXYZUW]", line) and re.search(r"[XYZUW]-?\d", line)]
    i = rng.choice(body)
    how = rng.choice(("word", "word", "line", "code"))
    if how == "word":
        found = list(re.finditer(r"([XYZUW])(=?)(-?\d+\.?\d*)", lines[i]))
        m = rng.choice(found)
        value = float(m.group(3)) + rng.choice((0.2, -0.2))
        lines[i] = lines[i][:m.start()] + f"{m.group(1)}{m.group(2)}{value:.4f}" + lines[i][m.end():]
    elif how == "line":
        del lines[i]
    else:
        changed = re.sub(r"G0(?!\d)", "G1", lines[i]) if "G0" in lines[i] else re.sub(r"G1(?!\d)", "G0", lines[i])
        if changed == lines[i]:
            return spoil(rng, text)
        lines[i] = changed
    return how, "\n".join(lines)


def run(options):
    options.keep = options.keep_refused = None
    options.invalid = False
    found = collections.Counter()
    j = judge.Judge(options)
    for dialect in readers.DIALECTS:
        machines = [(m, judge.profile(j.folder, dialect, m)) for m in compare.machines(dialect in readers.LATHES)]
        rng, done = random.Random(f"self {dialect}"), 0
        while done < options.count:
            try:
                text = readers.generate(dialect, rng, j.fresh())
                motions = readers.read(dialect, text, j.include)
            except Invalid:
                continue
            machine, path = rng.choice(machines)
            answer = j.correct(dialect, text, path)
            if answer[1]:
                continue
            done += 1
            how, damaged = spoil(rng, answer[0])
            try:
                right, output = (readers.read(dialect, t, j.include) for t in (answer[0], damaged))
            except (Invalid, ValueError, KeyError):
                found[how, "no program any more"] += 1
                continue
            if compare.compare(machine, right, output, False)[0] is None and repr(right) == repr(output):
                found[how, "means the same"] += 1
                continue
            inch = re.search(r"G70|G20|G700", text) is not None
            seen = compare.compare(machine, motions, output, inch)[0] is not None
            found[how, "seen" if seen else "NOT SEEN"] += 1
            if not seen:
                print(dialect, how, [(a, b) for a, b in zip(answer[0].split("\n"), damaged.split("\n")) if a != b][:1])
    print(dict(found))
    return 1 if any(k[1] == "NOT SEEN" for k in found) else 0
