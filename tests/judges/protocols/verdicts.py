"""What is right: each answer against the hidden truth."""

import math

import design
from machine import Row

FORECAST, HOPEFUL = 0.05, 0.10       # points of a forecast that are right, and that are too many
MATERIAL = 0.2                       # of the RMS before: a rise at a place that a user would call worse
EDGE = 0.04
HONEST = {"VP0913", "VP0914", "VP0916", "VP0919"}


class Truth:
    """What a case's machine does, and what its design can tell of it."""

    def __init__(self, case, measure):
        self.case, self.measure, machine = case, measure, case.hidden
        self.parts = machine.parts
        self.rms = {part: design.part_rms(measure, machine, part) for part in self.parts}
        whole = math.sqrt(sum(v * v for v in self.rms.values()))
        noise = max(measure.noise, measure.step / math.sqrt(12))
        self.snr = whole / noise
        self.main = [p for p in self.parts if self.rms[p] >= 3 * noise and self.rms[p] >= 0.45 * whole]
        self.names = {p.effect for p in self.parts}
        for part in self.parts:
            if self.rms[part] > 0.2 * noise:
                self.names |= design.sibling_ids(part.effect)
        self.known_noise = design.noise_is_known(measure, machine)
        self.facts = {}
        seen = [p for p in self.parts if self.rms[p] >= 2 * noise]
        for part in seen:
            others = [p for p in self.parts if p is not part]
            self.facts[part] = (*design.nearest_rival(measure, machine, part, others),
                                design.corner_reach(measure, machine, part, others))
        field = [part for part in seen if part.static and part.effect != "field"]
        knocks = [part for part in seen if part.effect.startswith("step")]
        self.correctable = bool(self.main) and bool(field) and len(field) + len(knocks) == len(seen)
        self.determined = self.correctable and self.known_noise and not case.slip and all(
            sine >= design.SINE and noises >= design.SIGMAS and reach <= design.REACH
            for sine, noises, _, reach in self.facts.values())

    def told(self):
        """For truth.json and the table of a failure."""
        return {"parts": [{"effect": p.effect, "size": p.size, "rms_um": round(self.rms[p], 3),
                           **{k: v for k, v in p.facts.items()}} for p in self.parts],
                "snr": round(self.snr, 2), "noise_um": self.measure.noise, "determined": self.determined,
                "noise_known": self.known_noise,
                "nearest": {p.effect: {"sine": round(f[0], 3), "noises": round(f[1], 1), "rival": f[2],
                                       "corner": round(f[3], 3)} for p, f in self.facts.items()},
                "slip": self.case.slip}


def grid(machine, travel, random):
    """Unseen places of a volume: its corners, a lattice, places by chance; each from both sides. The last 4 % of each
    way, which protocols leave out, are left out here too."""
    shares = [(a, b, c) for a in (EDGE, .5, 1 - EDGE) for b in (EDGE, .5, 1 - EDGE) for c in (EDGE, .5, 1 - EDGE)]
    shares += [tuple(random.uniform(EDGE, 1 - EDGE) for _ in range(3)) for _ in range(45)]
    rows = []
    for share in shares:
        q = [low + s * (high - low) for s, (low, high) in zip(share, travel)]
        for side in (1, -1):
            rows.append(Row("grid", q, (side, side, side)))
    return rows


def without_frame(rows, vectors, tool, comps):
    """Vectors less the shift and turn of a frame that fit them best, in the components that the instrument reads: what
    it cannot tell from its own frame is nobody's error."""
    columns = []
    for k in range(3):
        columns.append([float(j == k) for _ in rows for j in comps])
        column = []
        for row in rows:
            tip = [q + t for q, t in zip(row.q, row.tool or tool)]
            out = [0.0, 0.0, 0.0]
            out[(k + 1) % 3], out[(k + 2) % 3] = -tip[(k + 2) % 3], tip[(k + 1) % 3]
            column += [out[j] for j in comps]
        columns.append(column)
    flat = design.Space(columns).left([vector[j] for vector in vectors for j in comps])
    width = len(comps)
    return [flat[width * i:width * (i + 1)] for i in range(len(rows))]


def meant(machine, written):
    """The static faults that a correction is of: where all that is written is true, those that it names, since to undo
    one fault of two is right where they cancel, too; else all."""
    static = [part for part in machine.parts if part.static]
    named = [part for part in static if ({part.effect} | design.sibling_ids(part.effect)) & set(written)]
    known = set().union(*({part.effect} | design.sibling_ids(part.effect) for part in named))
    return named if set(written) <= known else static


def harm(machine, rows, predicted, stated, comps=(0, 1, 2), written=()):
    """(worst rise at a place, um; where; RMS before and after, um) of a correction against the static truth."""
    static = meant(machine, written) if written else [part for part in machine.parts if part.static]
    true = [machine.displacement(row, static) for row in rows]
    before = without_frame(rows, true, machine.tool, comps)
    after = without_frame(rows, [[a - b for a, b in zip(t, p)] for t, p in zip(true, predicted)], machine.tool, comps)
    rises = [(design.norm(b) - design.norm(a), row.q) for a, b, row in zip(before, after, rows)]
    rise, place = max(rises)
    count = math.sqrt(len(rows))
    rms = [design.norm([v for vector in field for v in vector]) / count for field in (before, after)]
    return {"rise_um": round(rise, 2), "at": [round(v, 1) for v in place], "stated_um": round(stated, 2),
            "before_um": round(rms[0], 2), "after_um": round(rms[1], 2),
            "harmed": rise > stated and rise > MATERIAL * rms[0]}


def shrink(measure, machine, values, predicted):
    """Achieved shrinkage on a file that nobody saw, set-up taken out before and after alike."""
    forms = design.setup(measure, machine)
    if measure.kind == "length":                   # a ball's place is known: what is common to all is the frame's
        forms = [lambda row, k=k: [float(j == k) for j in range(3)] for k in range(3)]
    space = design.Space([measure.column(form) for form in forms])
    read = [v for shown in values for v in shown]
    foretold = []
    for row, vector in zip(measure.rows, predicted):
        foretold += measure.read(row, vector)
    before = design.norm(space.left(read))
    after = design.norm(space.left([a - b for a, b in zip(read, foretold)]))
    return 1 - after / before if before else 0.0


def judge(truth, answer):
    """The flags of an answer that need no second command. All are booleans, or None where not asked."""
    names, rivals, written = answer.names(), answer.rivals(), answer.written()
    right = truth.names
    beside = {cause["effect"]: set(cause.get("cannot_be_told_from") or []) for cause in answer.causes}

    def false(effect):
        return effect not in right and not beside.get(effect, set()) & right
    sure = [e for e in names if false(e)] if answer.verdict == "NAMED" else []
    put = [e for e in written if false(e)] if "field" not in truth.names else []
    flags = {"wrong": sorted(set(sure) | set(put)), "in_set": None, "timid": None, "message": None, "clear": None}
    if truth.case.slip:
        flags["wrong"] = sorted(set(written))      # nothing may be written from a file with a slip
        flags["in_set"] = None
    honest = HONEST if not truth.case.slip else HONEST - {"VP0919"}
    if answer.status and (set(answer.codes) & honest or not (truth.case.slip and "VP0919" in answer.codes)):
        flags["message"] = ",".join(answer.codes) or f"exit status {answer.status}"
        return flags
    if truth.main and not truth.case.slip and "field" not in truth.names:
        set_named = set(names) | rivals
        if set_named or truth.determined:
            flags["in_set"] = all(({part.effect} | alike(part)) & set_named for part in truth.main)
        if truth.determined:
            flags["timid"] = answer.verdict not in ("NAMED", "AMBIGUOUS") or not written
    hidden = any(part.effect.startswith("pitch") for part in truth.parts) and not spacing_is_said(answer)
    if (truth.snr >= 3 or hidden) and answer.verdict == "NO GAP":
        flags["clear"] = True                      # an all-clear over a real gap
    return flags


def spacing_is_said(answer):
    """Does a note say that the steps cannot show what happens within a turn of a screw?"""
    return any("turn of a screw" in note for note in answer.diagnosis.get("notes") or [])


def alike(part):
    """Names of the same motion of the tool."""
    if part.effect in ("instrument-drift",) or part.effect.startswith("warmup"):
        return design.sibling_ids(part.effect)
    if part.effect.startswith("straightness.EZ"):
        return {f"sag.{part.effect[-1]}"}
    return set()
