"""Random but realistic mill programs that mix the codes on which controls differ.

Judges nothing by itself. A program is a list of lines as a post or a hand would write them: a safe start (often
incomplete), tool changes, bare and full G43, retracts by G53, G28 and G30, changes of offset, G52, G92 and G10, partial
axis words, increments, arcs, cycles, block delete, units, comments. After most of the codes that make a position
doubtful the program names every axis again, as posts do; after the others it goes on with what it has, as hands do.
"""

AXES = "XYZ"

FEATURES = {
    "fanuc": {"g53", "g28", "g30", "length", "bare-h", "offsets", "numbered", "g52", "g92", "g10", "change", "arc", "cycle", "inch", "delete"},
    "linuxcnc": {"g53", "g28", "g30", "length", "g52", "offsets", "g92", "g10", "change", "arc", "cycle", "inch", "delete", "loaded"},
    "centroid": {"g53", "g28", "g30", "length", "offsets", "change", "arc", "cycle", "inch", "delete", "m25"},
    "perspektiva": {"g28", "g30", "length", "bare-h", "offsets", "change", "arc", "cycle", "inch", "delete"},
    "balt-system": {"g79", "inch", "delete"},
    "sinumerik": {"g53", "offsets", "arc", "inch", "tool-word"},
}


class Writer:
    def __init__(self, random, machine, dialect):
        self.r, self.machine, self.dialect, self.can = random, machine, dialect, FEATURES[dialect]
        self.lines, self.inch, self.bare = [], False, False
        self.last = {}

    def chance(self, p):
        return self.r.random() < p

    def number(self, mm, exact=False):
        value = mm / 25.4 if self.inch else mm
        text = f"{value:.4f}" if self.inch else f"{value:.{3 if exact else self.r.choice([0, 1, 3, 3])}f}"
        text = text.rstrip("0") if "." in text else text + "."
        return "0." if text in ("-0.", "0.") else text

    def put(self, *parts):
        self.lines.append(" ".join(p for p in parts if p))

    def place(self, axes):
        """Words of these axes somewhere in the part; a plunge stays near the top."""
        spans = {"X": (-60, 120), "Y": (-80, 90), "Z": (-15, 60)}
        words = []
        for a in axes:
            value = round(self.r.uniform(*spans[a]), 3)
            self.last[a] = value
            words.append(a + self.number(value))
        return words

    def some(self):
        return self.r.choice(["X", "Y", "Z", "XY", "XY", "XZ", "YZ", "XYZ", "Z"])

    def name_all(self):
        style = self.r.randrange(3)
        if style == 0:
            self.put("G0", *self.place("XYZ"))
        elif style == 1:
            self.put("G0", *self.place("XY"))
            self.put(*self.place("Z"))
        else:
            self.put("G0", *self.place("Z"))
            self.put(*self.place("XY"))

    def after(self, p=0.55):
        """Behind a code that makes positions doubtful: all axes named, or only what comes."""
        if self.chance(p):
            self.name_all()

    def comment(self):
        text = self.r.choice(["ROUGHING", "TOOL 2 D10", "X10 Y20", "G53 Z0", "REST"])
        self.put(";" + text if self.dialect in ("balt-system", "sinumerik") else f"({text})")

    # --- what a program is made of ---
    def start(self):
        inch_codes = {"balt-system": ("G70", "G71"), "sinumerik": ("G70", "G71")}.get(self.dialect, ("G20", "G21"))
        self.units = inch_codes
        head = []
        if self.chance(0.93):
            self.inch = "inch" in self.can and self.chance(0.15)
            head.append(inch_codes[0] if self.inch else inch_codes[1])
        head += [c for c in ["G90", "G17", "G40", "G94"] if self.chance(0.8)]
        if "length" in self.can and self.chance(0.6):
            head.append("G49")
        if "cycle" in self.can and self.chance(0.6):
            head.append("G80")
        if self.chance(0.4):
            head.append("G54")
        self.r.shuffle(head)
        if self.chance(0.5):
            self.put(*head)
        else:
            for c in head:
                self.put(c)
        if self.chance(0.25):
            self.retract()

    def feeds(self):
        self.put("G1", *self.place(self.some()), "F" + self.r.choice(["100", "500.", "1200"]) if not self.inch else "F20.")
        for _ in range(self.r.randrange(3)):
            self.put(*self.place(self.some()))

    def rapids(self):
        self.put("G0", *self.place(self.some()))
        for _ in range(self.r.randrange(2)):
            self.put(*self.place(self.some()))

    def arc(self):
        if "arc" not in self.can:
            return self.feeds()
        exact = lambda mm: self.number(mm, True)
        r = round(self.r.uniform(5, 30), 3)
        x, y = round(self.r.uniform(-20, 60), 3), round(self.r.uniform(-30, 50), 3)
        self.put("G1" if self.chance(0.7) else "G0", "X" + exact(x), "Y" + exact(y), "F300.")
        kind = self.r.randrange(3)
        if kind == 0:
            self.put(self.r.choice(["G2", "G3"]), "I" + exact(r), "J" + self.number(0.0))
        elif kind == 1:
            self.put("G2", "X" + exact(x + 2 * r), "Y" + exact(y), "I" + exact(r), "J" + self.number(0.0))
            self.last["X"] = x + 2 * r
        else:
            self.put("G3", "X" + exact(x + r), "Y" + exact(y + r), "I" + self.number(0.0), "J" + exact(r))
            self.last.update(X=x + r, Y=y + r)

    def increments(self):
        self.put("G91")
        for _ in range(self.r.randrange(1, 4)):
            axis = self.r.choice("XYXYZ")
            self.put(self.r.choice(["G1", "G1", "G0"]), axis + self.number(round(self.r.uniform(-8, 8), 3)), "F400." if self.chance(0.5) else "")
        self.put("G90")

    def cycle(self):
        if "cycle" not in self.can:
            return self.feeds()
        words = [self.r.choice(["G98", "G99"]), self.r.choice(["G81", "G83", "G82", "G81"])]
        if self.chance(0.85):
            words += self.place("XY")
        words += ["Z" + self.number(-12.0), "R" + self.number(3.0)]
        if "G83" in words:
            words.append("Q" + self.number(4.0))
        if "G82" in words:
            words.append("P0.5" if self.dialect == "linuxcnc" else "P500")
        self.put(*words, "F150.")
        for _ in range(self.r.randrange(3)):
            self.put(*self.place(self.r.choice(["X", "Y", "XY"])))
        self.put("G80")
        if self.chance(0.4):
            self.rapids()

    def retract(self):
        kinds = [k for k in ("g53", "g28", "g30", "g79", "m25") if k in self.can]
        if not kinds:
            return
        kind = self.r.choice(kinds)
        top = 0.0 if self.machine.home[2] == 0.0 else 500.0
        if kind in ("g53", "g79"):
            name = "G53" if kind == "g53" else "G79"
            self.put(*self.r.choice([["G0", name], [name, "G0"]]), "Z" + self.number(top - self.r.choice([0, 0, 20])))
            if self.chance(0.3):
                self.put("G0", name, "X" + self.number(self.machine.travel["X"][0] + 350), "Y" + self.number(self.machine.travel["Y"][0] + 225))
        elif kind == "m25":
            self.put("M25")
        else:
            name = "G28" if kind == "g28" else self.r.choice(["G30", "G30 P2"]) if self.dialect == "fanuc" else "G30"
            axes = self.r.choice(["Z", "Z", "Z", "XY", "XYZ"])
            if self.chance(0.75):
                self.put("G91", name, *[a + "0." for a in axes])
                self.put("G90")
            else:
                self.put(name, *self.place(axes))
        self.after(0.35)

    def length(self):
        if "length" not in self.can:
            return self.retract()
        kind = self.r.randrange(7)
        h = f"H{self.r.choice([1, 2, 3])}"
        if kind <= 2:
            self.put("G43", h, *(["G0"] if self.chance(0.4) else []), *self.place("Z"))
        elif kind == 3:
            self.put("G43", h)
            self.after(0.5)
        elif kind == 4:
            self.put("G49", *(self.place("Z") if self.chance(0.3) else []))
            self.after(0.5)
        elif kind == 5:
            self.put(h if "bare-h" in self.can else "G43 " + h, *(self.place("Z") if self.chance(0.4) else []))
            self.after(0.4)
        else:
            if self.dialect == "fanuc" and self.chance(0.3):
                self.put(self.r.choice(["G44 " + h, "G43 H0", "H0"]))
            elif self.dialect == "linuxcnc":
                self.put(self.r.choice(["G43 H0", "G43"]))
            else:
                self.put("G43", h, "Z" + self.number(50.0))
            self.after(0.5)

    def change(self):
        t = self.r.choice([1, 2, 3])
        if "change" not in self.can:
            if "tool-word" in self.can and self.chance(0.3):
                self.put(f"T{t}")
            return
        if self.chance(0.6):
            self.retract()
        self.put(*self.r.choice([[f"T{t}", "M6"], ["M6", f"T{t}"]]))
        if self.chance(0.6):
            self.put("S3000 M3")
        if self.chance(0.3):
            self.put("G54")
        pattern = self.r.randrange(4)
        if pattern <= 1 and "length" in self.can:
            self.put("G0", *self.place("XY"))
            self.put(f"G43 H{t}", *self.place("Z"))
        elif pattern == 2:
            self.name_all()

    def frame(self):
        kinds = [k for k in ("offsets", "numbered", "g52", "g92", "g10") if k in self.can]
        if not kinds:
            return self.increments()
        kind = self.r.choice(kinds)
        if kind == "offsets":
            self.put(self.r.choice(["G54", "G55", "G56"] if self.dialect != "sinumerik" else ["G54", "G55", "G505"]))
        elif kind == "numbered":
            self.put("G54.1 P1")
        elif kind == "g52":
            axes = self.r.choice(["X", "Y", "XY", "Z", "XYZ"])
            self.put("G52", *[a + self.number(self.r.choice([0.0, 12.5, -20.0, 8.0])) for a in axes])
        elif kind == "g92":
            if self.chance(0.3):
                self.put("G92.1")
            else:
                axes = self.r.choice(["X", "Y", "XY", "XY", "Z"])
                self.put("G92", *[a + self.number(self.r.choice([0.0, 10.0, 25.0])) for a in axes])
        else:
            axes = self.r.choice(["X", "Z", "XY", "XYZ"])
            p = self.r.choice([1, 2])
            place = [v + self.r.choice([0.0, 5.0, -9.0]) for v in self.machine.offsets[f"G{53 + p}"]]
            self.put("G10", "L2", f"P{p}", *[a + self.number(place["XYZ".index(a)]) for a in axes])
        self.after(0.5)

    def skipped(self):
        self.lines.append("/" + self.r.choice(["G0 " + " ".join(self.place("Z")), "M8", "G1 " + " ".join(self.place("X")) + " F300."]))
        self.after(0.6)

    def unit(self):
        if "inch" not in self.can:
            return self.feeds()
        self.inch = not self.inch
        self.put(self.units[0] if self.inch else self.units[1])

    def program(self):
        head, tail = [], []
        if self.dialect in ("fanuc", "perspektiva") and self.chance(0.7):
            head, tail = ["%"] + (["O1234"] if self.dialect == "fanuc" else []), ["%"]
        self.start()
        if self.chance(0.7):
            self.change()
        if self.chance(0.6):
            self.name_all()
        menu = [(self.feeds, 6), (self.rapids, 5), (self.arc, 2), (self.increments, 2), (self.cycle, 2), (self.retract, 4), (self.length, 4),
                (self.change, 2), (self.frame, 3), (self.skipped, 1 if "delete" in self.can else 0), (self.unit, 0.4), (self.comment, 1)]
        for _ in range(self.r.randrange(3, 13)):
            self.r.choices([m for m, _ in menu], [w for _, w in menu])[0]()
        if self.chance(0.5):
            self.retract()
        if self.chance(0.9):
            self.put("M30")
        return head + self.lines + tail


def program(random, machine, dialect):
    """One program: a list of lines."""
    return Writer(random, machine, dialect).program()
