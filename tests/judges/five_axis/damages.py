"""Damages to a corrected five-axis program that `vpost check` has to find; each is one that a look at the text may miss."""

import os
import random
import re

from common import folders

import reader

ROTARY = re.compile(r"(?<![A-Z])([ABC])(=?)(-?\d*\.?\d+|-?\d+\.)")


def lines_with(lines, pattern, feed=None):
    """Numbers of lines with the pattern; `feed`: only those in G1 (True) or in G0 (False), as the modal code says."""
    out, mode = [], None
    for n, line in enumerate(lines):
        body = re.sub(r"\([^)]*\)", "", line).split(";")[0]
        m = re.findall(r"G0?([0-3])(?![0-9.])", body)
        if m:
            mode = int(m[-1])
        if re.search(pattern, body) and (feed is None or (mode is not None and (mode > 0) == feed)):
            out.append(n)
    return out


def word(line, pattern, change):
    """The line with the first number behind a letter of the pattern changed."""
    m = re.search(rf"(?<![A-Z])({pattern})(=?)(-?\d*\.?\d+|-?\d+\.)", line)
    return line[: m.start()] + m.group(1) + m.group(2) + f"{change(float(m.group(3))):.4f}" + line[m.end():]


def all_of(text, spec, rng):
    """(name, damaged text or None)."""
    lines = text.splitlines()
    names = [x.strip("[]") for x in spec["chain"].split() if x.strip("[]") in ("A", "B", "C")]
    first, last = names[0], names[-1]
    either = "[" + "".join(names) + "]"

    def pick(numbers, edit):
        numbers = numbers[1:] if len(numbers) > 1 else numbers
        if not numbers:
            return None
        n = rng.choice(numbers)
        new = edit(lines[n])
        if new == lines[n]:
            return None
        return "\n".join(lines[:n] + [new] + lines[n + 1:]) + "\n"

    turned = lines_with(lines, rf"(?<![A-Z]){either}=?-?[\d.]")
    yield "one degree", pick(turned, lambda s: word(s, either, lambda v: v + 1))
    yield "a tenth of a degree", pick(turned, lambda s: word(s, either, lambda v: v + 0.1))
    spin = [n for n in names if spec["rotary"][n]["travel"][1] > 400]
    if spin:
        with_spin = lines_with(lines, rf"(?<![A-Z]){spin[0]}=?-?[\d.]")
        yield "a turn more", pick(with_spin, lambda s: word(s, spin[0], lambda v: v + (360 if v < 0 else -360)))
    both = [n for n in turned if all(re.search(rf"(?<![A-Z]){k}=?-?[\d.]", lines[n]) for k in (first, last))]
    if spin and len(names) == 2 and any(n not in spin for n in names):
        tilt = next(n for n in names if n not in spin)
        yield "other branch", pick([n for n in both if abs(float(re.search(rf"(?<![A-Z]){tilt}=?(-?[\d.]+)", lines[n]).group(1))) > 0.1],
                                   lambda s: word(word(s, tilt, lambda v: -v), spin[0], lambda v: v + (180 if v < 0 else -180)))
    yield "rotary words swapped", pick(both, lambda s: word(word(s, first, lambda v: float(re.search(rf"(?<![A-Z]){last}=?(-?[\d.]+)", s).group(1))), last, lambda v: float(re.search(rf"(?<![A-Z]){first}=?(-?[\d.]+)", s).group(1))))
    yield "a rotary word dropped", pick(turned, lambda s: re.sub(rf"\s*(?<![A-Z]){either}=?-?[\d.]+", "", s, count=1))
    feeds = lines_with(lines, r"[XYZ]-?[\d.]", feed=True)
    yield "20 um", pick(feeds, lambda s: word(s, "[XYZ]", lambda v: v + 0.02))
    yield "F times ten", pick(lines_with(lines, r"F[\d.]", feed=True), lambda s: word(s, "F", lambda v: v * 10))
    yield "a feed left out", pick(feeds[:-1], lambda s: "")


def judge(vpost, spec, result, folder, check, seed, orientation=None):
    """{name: "found", "missed" or "harmless"}: whether `check` finds each damage that makes another motion of the program."""
    import compare

    out = {}
    rng = random.Random(seed)
    if spec["axes"]["X"].get("backlash_um") or spec["axes"]["Y"].get("backlash_um") or spec["axes"]["Z"].get("backlash_um"):
        return out
    with open(result["source"], encoding="ascii") as file:
        original = file.read()
    wanted, _ = reader.read(original, spec)
    for name, text in all_of(result["out"], spec, rng):
        if text is None:
            continue
        path = folders.put(folder, "damaged.nc", text)
        answer = check(vpost, result["source"], path, result["options"])
        if answer.get("passed") is True:
            # Is it one? A dropped word may say what holds already, 20 um may lie along the path, a line may be a short one.
            try:
                taken, _ = reader.read(text, spec)
                directed = orientation == "full"
                found = compare.compare(spec, wanted, taken, directed)
                real = found["um"] > found["limit_um"] + 0.1 or found["turned"] > (compare.ASIDE if directed else compare.TURNED) or bool(compare.times(wanted, taken, found))
                allowed = spec.get("orientation_urad", 20.0) + 1.0
                real |= directed and max(found["far_tilt_urad"], found["worse_tilt_urad"]) > allowed
            except (compare.Structure, reader.Unreadable):
                real = True
            out[name] = "missed" if real else "harmless"
            if real:
                os.replace(path, os.path.join(folder, name.replace(" ", "-") + ".nc"))
        else:
            out[name] = "found"
    return out
