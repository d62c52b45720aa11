"""Small edits of a corrected program that change what happens to the part, and some that do not.

Each kind is a function of a `Text` that makes one edit by chance and returns the new lines, or None where the program has
nothing to damage in that way. KINDS must be found by `vpost check`, HARMLESS must pass.
"""

import random
import re

from reader import CYCLES, Event

TOKEN = re.compile(r"([A-Za-z])([-+]?(?:\d+\.?\d*|\.\d+))")


class Text:
    """A program's lines and what is known of each."""

    def __init__(self, lines, items, dialect, seed, inch_lines):
        self.lines, self.dialect, self.pick, self.inch = lines, dialect, random.Random(seed), inch_lines
        self.motions, self.events = {}, {}
        for item in items:
            table = self.events if isinstance(item, Event) else self.motions
            table.setdefault(item.line - 1, []).append(item)
        self.end = max(self.motions) if self.motions else 0

    def words(self, at):
        """(letter, text, start, end) of the words of a line, comments left out."""
        text = self.lines[at]
        masked = re.sub(r"\([^)]*\)", lambda m: " " * len(m.group()), text)
        if ";" in masked:
            masked = masked[: masked.index(";")]
        if masked.lstrip().startswith(("%", "O", ":")):
            return []
        return [(m.group(1).upper(), m.group(2), m.start(), m.end()) for m in TOKEN.finditer(masked)]

    def codes(self, at):
        return {f"{letter}{float(text):g}" for letter, text, _, _ in self.words(at) if letter in "GM"}

    def cuts(self, at):
        return any(not m.rapid and m.length > 0.3 for m in self.motions.get(at, []))

    def rapids(self, at):
        return any(m.rapid for m in self.motions.get(at, []))

    def any_word(self, good):
        """A word by chance, (line, word), of those that `good(line, word)` takes."""
        found = [(k, w) for k in range(len(self.lines)) for w in self.words(k) if good(k, w)]
        return self.pick.choice(found) if found else None

    def put(self, at, word, text):
        """The lines with one word replaced."""
        line = self.lines[at]
        return self.lines[:at] + [line[: word[2]] + text + line[word[3] :]] + self.lines[at + 1 :]

    def without(self, at):
        return self.lines[:at] + self.lines[at + 1 :]

    def swap_word(self, good, new):
        found = self.any_word(good)
        if not found:
            return None
        at, word = found
        text = new(word, at)
        return None if text is None else self.put(at, word, text)

    def line_with(self, good):
        found = [k for k in range(len(self.lines)) if good(k)]
        return self.pick.choice(found) if found else None

    def drop_line(self, good):
        at = self.line_with(good)
        return None if at is None else self.without(at)

    def step_after(self, at, good):
        return next((k for k in range(at + 1, len(self.lines)) if good(k)), None)

    def moved_past_a_cut(self, good):
        """A line without motion carried behind the next block that cuts."""
        lines = [k for k in range(len(self.lines)) if good(k) and not self.motions.get(k)]
        self.pick.shuffle(lines)
        for at in lines:
            cut = self.step_after(at, self.cuts)
            if cut is not None:
                return self.lines[:at] + self.lines[at + 1 : cut + 1] + [self.lines[at]] + self.lines[cut + 1 :]
        return None

    def moved_before_a_cut(self, good):
        lines = [k for k in range(len(self.lines)) if good(k) and not self.motions.get(k)]
        self.pick.shuffle(lines)
        for at in lines:
            cut = next((k for k in range(at - 1, -1, -1) if self.cuts(k)), None)
            if cut is not None:
                return self.lines[:cut] + [self.lines[at]] + self.lines[cut:at] + self.lines[at + 1 :]
        return None

    def in_cycle(self, at):
        return any(m.cycle for m in self.motions.get(at, []))



def code(t, old, new, where=lambda k: True):
    return t.swap_word(lambda k, w: f"{w[0]}{float(w[1]):g}" in old and where(k), lambda w, k: new)


def scaled(text, factor):
    decimals = len(text.split(".")[1]) if "." in text else 0
    out = f"{float(text) * factor:.{max(decimals, 1)}f}"
    return out


def off(t, by_um):
    """A length word moved by some micrometres, whichever way it is written."""

    def new(word, at):
        text = word[1]
        if "." not in text:
            if t.dialect == "fanuc":
                return None
            text += "."
        decimals = 4 if t.inch[at] else 3
        by = by_um * 1e-3 / 25.4 if t.inch[at] else by_um * 1e-3
        return word[0] + f"{float(text) + t.pick.choice([-by, by]):.{decimals}f}"

    return new


def numbered(letter, factor):
    return lambda w, k: letter + scaled(w[1], factor)


def length_word(letter, where):
    return lambda t: t.swap_word(lambda k, w: w[0] == letter and where(t, k), off(t, 20))


def flip(t):
    return t.swap_word(
        lambda k, w: w[0] in "XYZ" and (t.cuts(k) or t.rapids(k)) and abs(float(w[1])) > 0.5,
        lambda w, k: w[0] + (w[1][1:] if w[1][0] == "-" else "-" + w[1].lstrip("+")),
    )


def cycle_block(t, k):
    return any(f"G{c}" in t.codes(k) for c in CYCLES)


def hole_line(t, k):
    return t.in_cycle(k) and not cycle_block(t, k)


def add_hole(t):
    at = t.line_with(lambda k: hole_line(t, k) and all(w[0] in "NXY" for w in t.words(k)))
    if at is None or "G91" in "".join(t.lines[max(0, at - 1) : at + 1]):
        return None
    x = next((w for w in t.words(at) if w[0] == "X"), None)
    if x is None:
        return None
    extra = f"X{float(x[1]) + (0.3 if t.inch[at] else 7):.3f}"
    return t.lines[: at + 1] + [extra] + t.lines[at + 1 :]


def cut_lines(t):
    return [k for k in range(len(t.lines)) if t.cuts(k) and not t.in_cycle(k)]


def doubled(t):
    """Two cuts one after the other made twice: back to where the first began, and again."""
    cuts = [k for k in cut_lines(t) if k + 1 in t.motions and t.cuts(k + 1) and not t.in_cycle(k + 1) and not (t.codes(k) | t.codes(k + 1))]
    cuts = [k for k in cuts if all(w[0] in "NXYZ" for j in (k, k + 1) for w in t.words(j)) and {w[0] for w in t.words(k)} == {w[0] for w in t.words(k + 1)}]
    if not cuts:
        return None
    k = t.pick.choice(cuts)
    strip = [re.sub(r"^\s*N\d+\s*", "", t.lines[j]) for j in (k, k + 1)]
    return t.lines[: k + 2] + strip + t.lines[k + 2 :]


def circle_doubled(t):
    k = t.line_with(lambda k: t.cuts(k) and any(m.arc and abs(m.arc.sweep) > 6.28 for m in t.motions[k]))
    return None if k is None else t.lines[: k + 1] + [re.sub(r"^\s*N\d+\s*", "", t.lines[k])] + t.lines[k + 1 :]


def exchanged(t):
    cuts = [k for k in cut_lines(t) if k + 1 in t.motions and t.cuts(k + 1) and not t.in_cycle(k + 1)]
    if not cuts:
        return None
    k = t.pick.choice(cuts)
    return t.lines[:k] + [t.lines[k + 1], t.lines[k]] + t.lines[k + 2 :]


def before_a_cut(text):
    def edit(t):
        at = t.line_with(t.cuts)
        return None if at is None else t.lines[:at] + [text] + t.lines[at:]

    return edit


def begun_later(t):
    at = t.line_with(lambda k: t.codes(k) & {"G41", "G42"})
    after = t.step_after(at, t.cuts) if at is not None else None
    if after is None:
        return None
    words = [w for w in t.words(at) if w[0] == "D" or f"{w[0]}{float(w[1]):g}" in ("G41", "G42")]
    line = t.lines[at]
    for w in reversed(words):
        line = line[: w[2]] + " " * (w[3] - w[2]) + line[w[3] :]
    new = " ".join(t.lines[at][w[2] : w[3]] for w in words)
    first = re.match(r"\s*(N\d+)?", t.lines[after]).end()
    return t.lines[:at] + [line] + t.lines[at + 1 : after] + [t.lines[after][:first] + " " + new + " " + t.lines[after][first:]] + t.lines[after + 1 :]


def drop_word(t, good):
    return t.swap_word(good, lambda w, k: "")


def retract(t):
    def good(k):
        return any(m.rapid and m.known and m.end[2] > m.start[2] + 1 for m in t.motions.get(k, [])) and not t.in_cycle(k)

    return t.drop_line(good)


def inverse_lines(t):
    return {k for k, ms in t.motions.items() if any(m.minutes for m in ms)}



def insert_code(text, back, where):
    """A code in force for one cut only."""

    def edit(t):
        at = t.line_with(lambda k: where(t, k))
        if at is None:
            return None
        return t.lines[:at] + [text] + [t.lines[at]] + [back] + t.lines[at + 1 :]

    return edit


def arcs(t, k):
    return any(m.arc and abs(m.arc.sweep) * m.arc.radii[0] > 0.3 for m in t.motions.get(k, []))


def dwell(t, k):
    return "G4" in t.codes(k)


def last_third(t):
    cut = 2 * len(t.lines) // 3
    return t.lines[:cut] + ["M30"]


def one_more(name, first=1):
    return lambda w, k: f"{name}{int(float(w[1])) % 3 + first}"


def word_is(*names):
    return lambda k, w: f"{w[0]}{float(w[1]):g}" in names



KINDS = {
    "feed ten times": lambda t: t.swap_word(lambda k, w: w[0] == "F", numbered("F", 10)),
    "feed 5 % more": lambda t: t.swap_word(lambda k, w: w[0] == "F", numbered("F", 1.05)),
    "F removed": lambda t: drop_word(t, lambda k, w: w[0] == "F"),
    "inverse-time F doubled": lambda t: t.swap_word(lambda k, w: w[0] == "F" and k in inverse_lines(t), numbered("F", 2)),
    "dwell lost": lambda t: t.drop_line(lambda k: dwell(t, k)),
    "dwell past a cut": lambda t: t.moved_past_a_cut(lambda k: dwell(t, k)),
    "dwell before a cut": lambda t: t.moved_before_a_cut(lambda k: dwell(t, k)),
    "dwell time doubled": lambda t: t.swap_word(lambda k, w: w[0] in "PX" and dwell(t, k), lambda w, k: w[0] + (scaled(w[1], 2) if "." in w[1] else str(2 * int(w[1])))),
    "cycle's P changed": lambda t: t.swap_word(lambda k, w: w[0] == "P" and t.in_cycle(k), lambda w, k: "P" + (scaled(w[1], 2) if "." in w[1] else str(2 * int(w[1])))),
    "cycle's P lost": lambda t: drop_word(t, lambda k, w: w[0] == "P" and t.in_cycle(k)),
    "cycle's Q halved": lambda t: t.swap_word(lambda k, w: w[0] == "Q", numbered("Q", 0.5)),
    "cycle's R 1 mm up": lambda t: t.swap_word(lambda k, w: w[0] == "R" and t.in_cycle(k) and "." in w[1], lambda w, k: f"R{float(w[1]) + (0.04 if t.inch[k] else 1):.4f}"),
    "hole 20 um deeper": lambda t: t.swap_word(lambda k, w: w[0] == "Z" and t.in_cycle(k) and "." in w[1], lambda w, k: f"Z{float(w[1]) - (0.0008 if t.inch[k] else 0.02):.4f}"),
    "G84 becomes G81": lambda t: code(t, ("G84", "G74"), "G81"),
    "G84 becomes G86": lambda t: code(t, ("G84",), "G86"),
    "G81 becomes G85": lambda t: code(t, ("G81", "G82"), "G85"),
    "G85 becomes G81": lambda t: code(t, ("G85", "G89"), "G81"),
    "G83 becomes another": lambda t: code(t, ("G83",), "G81" if t.dialect == "perspektiva" else "G73"),
    "G82 becomes G81": lambda t: code(t, ("G82",), "G81"),
    "G98 becomes G99": lambda t: code(t, ("G98",), "G99"),
    "G99 becomes G98": lambda t: code(t, ("G99",), "G98"),
    "M9 past a cut": lambda t: t.moved_past_a_cut(lambda k: "M9" in t.codes(k)),
    "M9 before a cut": lambda t: t.moved_before_a_cut(lambda k: "M9" in t.codes(k)),
    "M8 lost": lambda t: drop_word(t, word_is("M8")),
    "M8 past a cut": lambda t: t.moved_past_a_cut(lambda k: "M8" in t.codes(k)),
    "M8 becomes M7": lambda t: code(t, ("M8",), "M7"),
    "M3 becomes M4": lambda t: code(t, ("M3",), "M4"),
    "M3 lost": lambda t: drop_word(t, word_is("M3")),
    "S changed": lambda t: t.swap_word(lambda k, w: w[0] == "S", lambda w, k: f"S{int(float(w[1])) + 300}"),
    "S past a cut": lambda t: t.moved_past_a_cut(lambda k: any(w[0] == "S" for w in t.words(k)) and not t.codes(k)),
    "M5 before a cut": before_a_cut("M5"),
    "M9 added before a cut": before_a_cut("M9"),
    "T changed": lambda t: t.swap_word(lambda k, w: w[0] == "T", one_more("T")),
    "M6 lost": lambda t: drop_word(t, word_is("M6")),
    "H changed": lambda t: t.swap_word(lambda k, w: w[0] == "H", one_more("H")),
    "G43 lost": lambda t: drop_word(t, word_is("G43")),
    "D changed": lambda t: t.swap_word(lambda k, w: w[0] == "D", one_more("D")),
    "G41 becomes G42": lambda t: code(t, ("G41",), "G42"),
    "G42 becomes G41": lambda t: code(t, ("G42",), "G41"),
    "G40 lost": lambda t: drop_word(t, lambda k, w: word_is("G40")(k, w) and k > 8),
    "compensation a block later": begun_later,
    "a cut removed": lambda t: t.drop_line(lambda k: t.cuts(k) and not t.in_cycle(k)),
    "cuts doubled": doubled,
    "a circle doubled": circle_doubled,
    "two cuts exchanged": exchanged,
    "arc's direction": lambda t: t.swap_word(lambda k, w: word_is("G2", "G3")(k, w) and arcs(t, k), lambda w, k: "G2" if float(w[1]) == 3 else "G3"),
    "arc becomes a line": lambda t: next(
        (t.lines[:k] + [re.sub(r"[IJKR][-+.\d]+", "", re.sub(r"G0?[23](?!\d)", "G1", t.lines[k]))] + t.lines[k + 1 :] for k in range(len(t.lines)) if t.codes(k) & {"G2", "G3"} and arcs(t, k)), None
    ),
    "arc's centre 50 um off": lambda t: t.swap_word(lambda k, w: w[0] in "IJK" and arcs(t, k) and "." in w[1], off(t, 50)),
    "retract removed": retract,
    "rapid becomes feed": lambda t: code(t, ("G0",), "G1", t.rapids),
    "feed becomes rapid": lambda t: code(t, ("G1",), "G0", t.cuts),
    "hole removed": lambda t: t.drop_line(lambda k: hole_line(t, k)),
    "hole added": add_hole,
    "hole 20 um off": lambda t: t.swap_word(lambda k, w: w[0] in "XY" and t.in_cycle(k) and not t.codes(k) & {"G91"}, off(t, 20)),
    "cut 20 um off": lambda t: t.swap_word(lambda k, w: w[0] in "XYZ" and t.cuts(k) and not t.in_cycle(k), off(t, 20)),
    "rapid 20 um off": lambda t: t.swap_word(lambda k, w: w[0] in "XYZ" and t.rapids(k) and not t.in_cycle(k), off(t, 20)),
    "sign flipped": flip,
    "word of a cut lost": lambda t: drop_word(t, lambda k, w: w[0] in "XYZ" and t.cuts(k)),
    "repeats changed": lambda t: t.swap_word(lambda k, w: w[0] in "KL" and t.in_cycle(k) and "." not in w[1], lambda w, k: f"{w[0]}{int(w[1]) - 1}"),
    "M0 lost": lambda t: drop_word(t, word_is("M0")),
    "M1 lost": lambda t: drop_word(t, word_is("M1")),
    "M1 past a cut": lambda t: t.moved_past_a_cut(lambda k: "M1" in t.codes(k)),
    "end lost": lambda t: t.drop_line(lambda k: t.codes(k) & {"M30", "M2"}),
    "program cut short": last_third,
    "G94 becomes G95": lambda t: code(t, ("G94",), "G95"),
    "G93 becomes G94": lambda t: code(t, ("G93",), "G94"),
    "G95 for one cut": insert_code("G95", "G94", lambda t, k: t.cuts(k) and k not in inverse_lines(t)),
    "G61 for one cut": insert_code("G61", "G64", lambda t, k: t.cuts(k)),
    "plane changed": lambda t: code(t, ("G17", "G18", "G19"), "G18" if t.pick.random() < 0.5 else "G19"),
    "units changed": lambda t: t.swap_word(lambda k, w: word_is("G20", "G21")(k, w), lambda w, k: "G20" if float(w[1]) == 21 else "G21"),
    "G90 becomes G91": lambda t: code(t, ("G90",), "G91", lambda k: k > 8),
    "G54 becomes G55": lambda t: t.swap_word(word_is("G54", "G55"), lambda w, k: "G55" if float(w[1]) == 54 else "G54"),
    "G68's angle": lambda t: t.swap_word(lambda k, w: w[0] == "R" and "G68" in t.codes(k), lambda w, k: f"R{float(w[1]) + 1:.1f}"),
    "G69 lost": lambda t: t.drop_line(lambda k: "G69" in t.codes(k)),
    "G80 lost": lambda t: drop_word(t, lambda k, w: word_is("G80")(k, w) and k > 8),
}


# Whether these have an effect only the path can tell: a corner moved along a straight line changes nothing.
GEOMETRIC = {
    "cut 20 um off", "rapid 20 um off", "arc's centre 50 um off", "a cut removed", "word of a cut lost", "two cuts exchanged", "arc becomes a line",
    "retract removed", "sign flipped", "cuts doubled", "hole 20 um off",
}  # fmt: skip


def renumber(t):
    out, count = [], t.pick.randint(1, 5000)
    for k, line in enumerate(t.lines):
        if any(w[0] == "N" for w in t.words(k)):
            w = next(w for w in t.words(k) if w[0] == "N")
            count += t.pick.randint(1, 7)
            line = line[: w[2]] + f"N{count}" + line[w[3] :]
        out.append(line)
    return out


def respelled(t, change):
    out = []
    for k in range(len(t.lines)):
        line = t.lines[k]
        for w in reversed(t.words(k)):
            line = line[: w[2]] + change(w) + line[w[3] :]
        out.append(line)
    return out


def shuffled(t):
    """Words of a block in another order; N stays first."""
    out = []
    for k in range(len(t.lines)):
        words = t.words(k)
        text = t.lines[k]
        if len(words) < 2 or "(" in text or ";" in text or text.startswith("/"):
            out.append(text)
            continue
        first = [text[w[2] : w[3]] for w in words if w[0] == "N"]
        rest = [text[w[2] : w[3]] for w in words if w[0] != "N"]
        t.pick.shuffle(rest)
        out.append(" ".join(first + rest))
    return out


def remarks(t):
    out = []
    for k, line in enumerate(t.lines):
        good = line.strip() and not line.startswith(("%", "O", ":")) and "(" not in line and ";" not in line
        out.append(line + " (REMARK M5 X1.)" if good and t.pick.random() < 0.3 else line)
    return out


HARMLESS = {
    "comments": remarks,
    "N numbers": renumber,
    "words in another order": shuffled,
    "X1. as X1.0": lambda t: respelled(t, lambda w: w[0] + w[1] + "0" if "." in w[1] and w[0] in "XYZIJKRFQ" else w[0] + w[1]),
    "G1 as G01": lambda t: respelled(t, lambda w: f"{w[0]}0{w[1]}" if w[0] in "GM" and len(w[1]) == 1 else w[0] + w[1]),
    "empty lines": lambda t: [x for line in t.lines for x in ([line, ""] if t.pick.random() < 0.2 else [line])],
    "lower case": lambda t: [line if line.startswith(("%", "O", ":")) or "(" in line else line.lower() for line in t.lines],
}
