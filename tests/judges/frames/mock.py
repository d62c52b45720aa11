"""A stand-in for a right corrector, for the judge's self-test: whatever it writes must not be blamed.

It keeps every rule that the judge knows and corrects nothing: each own absolute word of a motion is changed by a random
amount within a third of the allowed correction, increments by differences of such amounts, G92 words by what the axis is
off, and nothing else is touched. Behind codes that move axes by themselves the amounts are forgotten.
"""

import re

import control

MOTION = re.compile(r"([XYZ])([+-]?(?:\d+\.?\d*|\.\d+))")


def output(lines, machine, dialect, random):
    """The program with markers, as a right corrector might have written it."""
    limit = machine.limit()
    off = dict.fromkeys("XYZ", 0.0)
    inch = incremental = False
    written = []
    for k, line in enumerate(lines):
        parsed = control.words_of(line, dialect)
        new = line
        if parsed:
            gs = {control.code(v) for letter, v, _ in parsed[1] if letter == "G"}
            ms = {control.code(v) for letter, v, _ in parsed[1] if letter == "M"}
            inch = (inch or bool(gs & {"20", "70"})) and not gs & {"21", "71"}
            incremental = (incremental or "91" in gs) and "90" not in gs
            unit = 25.4 if inch else 1.0
            if "6" in ms or "25" in ms:
                off = dict.fromkeys("XYZ", 0.0)
            if gs & {"53", "79", "153", "28", "30"} and not (dialect == "balt-system" and "28" in gs):
                for letter, _, _ in parsed[1]:
                    if letter in off:
                        off[letter] = 0.0
            elif "92" in gs:
                new = MOTION.sub(lambda m: f"{m[1]}{float(m[2]) + off[m[1]] / unit:.4f}", line)
            elif not gs & {"4", "10", "52"}:
                def change(m):
                    a, before = m[1], off[m[1]]
                    off[a] = random.uniform(-0.3, 0.3) * limit["XYZ".index(a)]
                    return f"{a}{float(m[2]) + (off[a] - (before if incremental else 0.0)) / unit:.4f}"
                cycle = bool(re.search(r"G8[123]", line))
                new = MOTION.sub(change, line)
                if cycle:
                    off["Z"] = 0.0
        written.append(new)
    mark = (lambda k: f";@{k}") if dialect in ("balt-system", "sinumerik") else (lambda k: f"(@{k})")
    return "".join(f"{x}\n{mark(k)}\n" for k, x in enumerate(written))
