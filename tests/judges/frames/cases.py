"""The directed tests, by item of the issue. How they are run: directed.py."""

import re


class Test:
    def __init__(self, name, dialect, program, expect, item=None, args=(), extra="", either=None, says=None, silent=None, judged=None,
                 holds=None, rotary=False, check=None, start_at=None, blames=None, like=None, once=False):
        self.name, self.dialect, self.expect = name, dialect, expect
        self.item = item or name.split("-")[0]
        self.text = program if isinstance(program, str) else "\n".join(program) + "\n"
        self.lines = self.text.rstrip("\n").split("\n")
        self.args, self.extra, self.either, self.says, self.silent = list(args), extra, either, says, silent
        self.judged, self.holds, self.rotary, self.check, self.start_at = judged, holds, rotary, check, start_at
        self.blames, self.like, self.once = blames, like, once
        if start_at:
            self.args.append("--start-at=" + ",".join(f"{x:g}" for x in start_at))


HEAD = {"sinumerik": ["G71 G90 G17 G54"], "balt-system": ["G71 G90 G17"], "perspektiva": ["G21 G90 G17 G54"]}
START = [-400.0, -240.0, -350.0]


def mill(dialect, *blocks, units=True):
    """A small milling program round these blocks: all axes named in front, feeds behind."""
    head = HEAD.get(dialect, ["G21 G90 G17 G54"]) if units else ["G90 G17 G54"]
    return head + ["G0 X10. Y10. Z50."] + list(blocks) + ["M30"]


def axis_words(text):
    return re.findall(r"([XYZ])\s*=?\s*([+-]?[\d.]+)", re.sub(r"\([^)]*\)|;.*", "", text))


def not_as_it_was(text, output):
    return "the program came out unchanged" if text == output else ""


def keeps_block(block):
    return lambda text, output: "" if block in output.split("\n") else f"{block!r} is not as it was"


def moved_somewhere(block):
    """The words of this block have been corrected: as they were is wrong."""
    return lambda text, output: f"{block!r} came out as it went in" if block in output.split("\n") else ""


def all_tests():
    return item_1() + item_2() + item_3() + item_4() + item_5() + item_8() + item_10() + item_11()


def item_1():
    # The axis stands elsewhere and leans, as a body: whatever turns with it is displaced alike at every angle, so that the
    # linear axes, standing, ask for no other command. A feed of it alone is right as it is; one whose error changes on
    # the way is the five-axis judge's.
    def t(name, dialect, blocks, expect="pass", blames=None, **more):
        head = HEAD.get(dialect, ["G21 G90 G17 G54"])
        lines = head + ["G0 A0." if dialect != "sinumerik" else "G0 A=0", "G0 X10. Y10. Z50."] + blocks + ["M30"]
        return Test("1-" + name, dialect, lines, expect, rotary=True, blames=blames, **more)

    return [
        t("rotary-feed-alone", "fanuc", ["G1 A60. F500."]),
        t("rotary-feed-modal", "fanuc", ["G1 X20. F500.", "A60."]),
        t("rotary-feed-g93", "fanuc", ["G93 G1 A60. F2."]),
        t("rotary-feed-incremental", "fanuc", ["G91 G1 A30. F500.", "G90"]),
        t("rotary-feed-linuxcnc", "linuxcnc", ["G1 A60. F500."]),
        t("rotary-feed-sinumerik", "sinumerik", ["G1 A=60 F500"]),
        t("rotary-feed-g93-linuxcnc", "linuxcnc", ["G93 G1 A60. F2."]),
        t("rotary-feed-centroid", "centroid", ["G1 A-45. F300."]),
        t("rotary-feed-perspektiva", "perspektiva", ["G1 A-45. F300."]),
        t("rotary-indexed-by-g0", "fanuc", ["G0 A60.", "G0 X10. Y10. Z50.", "G1 X20. F500."], "pass"),
        t("check-sees-a-rotary-feed", "fanuc", ["G0 A60.", "G0 X20. Y10. Z50.", "G1 Z20. F500."], check=("G0 A60.", "G1 A60. F500.")),
        t("check-sees-a-rotary-feed-linuxcnc", "linuxcnc", ["G0 A60.", "G0 X20. Y10. Z50.", "G1 Z20. F500."], check=("G0 A60.", "G1 A60. F500.")),
        t("check-passes-an-index", "fanuc", ["G0 A60.", "G0 X20. Y10. Z50.", "G1 Z20. F500."], "pass", check=("G0 A60.", "G0 A60.")),
    ]


def lathe(*blocks, head=("G21 G40", "T0101")):
    return list(head) + ["G0 X50. Z5."] + list(blocks) + ["G0 X100. Z100.", "M30"]


def item_2():
    """Signs of a lathe. --start-at makes Y known, so that nothing but the sign can refuse the program."""
    named = r"lathe|turn(ing|ed)"
    l = lambda name, blocks, dialect="fanuc", head=("G21 G40",): Test("2-" + name, dialect, lathe(*blocks, head=head), "refuse", says=named, start_at=START)
    thread = lambda test: setattr(test, "says", named + "|thread|diameter") or test
    cut = ["G1 Z-30. F0.2", "X52."]
    m = lambda name, blocks, dialect="fanuc": Test("2-mill-" + name, dialect, mill(dialect, *blocks), "pass", silent=named)
    return [
        l("g96-with-g50-s", ["G50 S2000", "G96 S200 M3"] + cut),
        l("g96-with-g92-s", ["G92 S2500", "G96 S200 M3"] + cut),
        l("four-digit-t", cut, head=("G21 G40", "T0101")),
        l("u-and-w-beside-x-and-z", ["G1 X52. F0.2", "G1 U2. W-5.", "X60. W-10."]),
        l("g90-turning-cycle", ["G90 X45. Z-25. F0.25", "X40.", "X35."]),
        thread(l("g92-threading-cycle", ["G97 S600 M3", "G92 X29.4 Z-20. F1.5", "X29."])),
        l("g94-facing-cycle", ["G94 X20. Z-2. F0.2", "Z-4."]),
        l("g71-with-p-q", ["G71 U2. R0.5", "G71 P10 Q20 U0.4 W0.1 F0.25", "N10 G0 X20.", "G1 Z-20.", "N20 X50."]),
        l("g70-with-p-q", ["N10 G0 X20.", "G1 Z-20.", "N20 X50.", "G70 P10 Q20"]),
        l("g72-with-p-q", ["G72 W2. R0.5", "G72 P10 Q20 U0.4 W0.1 F0.25", "N10 G0 Z-20.", "G1 X20.", "N20 Z2."]),
        l("g73-with-p-q", ["G73 U10. W5. R5", "G73 P10 Q20 U0.4 W0.1 F0.25", "N10 G0 X20.", "G1 Z-20.", "N20 X50."]),
        thread(l("g76-threading", ["G97 S600 M3", "G76 P010060 Q100 R50", "G76 X27.4 Z-20. P920 Q300 F1.5"])),
        l("g74-peck-of-a-lathe", ["G74 R1.", "G74 Z-20. Q5000 F0.1"]),
        l("g75-grooving", ["G75 R1.", "G75 X20. Z-10. P3000 Q2000 F0.1"]),
        thread(l("g32-thread", ["G32 Z-20. F1.5"])),
        l("g50-preset", ["G50 X200. Z100.", "G0 X50. Z5."] + cut),
        l("whole-program", ["G50 S2000", "G96 S200 M3", "G99 G71 U2. R0.5", "G71 P10 Q20 U0.4 W0.1 F0.25", "N10 G0 X20.", "G1 Z-20.", "N20 X50."], head=("G21 G40", "T0101")),
        l("g96-with-g50-s-centroid", ["G50 S2000", "G96 S200 M3"] + cut, "centroid"),
        l("g96-with-g92-s-perspektiva", ["G92 S2500", "G96 S200 M3"] + cut, "perspektiva"),
        l("four-digit-t-perspektiva", cut, "perspektiva", ("G21 G40", "T0101")),
        l("g71-with-p-q-centroid", ["G71 U2. R0.5", "G71 P10 Q20 U0.4 W0.1 F0.25"] + cut, "centroid"),
        l("diamon", ["DIAMON"] + cut, "sinumerik", ("G71 G54 G90",)),
        l("g96-with-lims", ["LIMS=3000", "G96 S200 M3"] + cut, "sinumerik", ("G71 G54 G90",)),
        thread(l("g7-diameter", ["G7"] + cut, "linuxcnc")),
        l("g96-with-d", ["G96 D2500 S200 M3"] + cut, "linuxcnc"),
        thread(l("g76-linuxcnc", ["G76 P1.5 Z-20. I-1. J0.2 R1. K0.9 Q29. H2 E0.1 L2"], "linuxcnc")),
        m("g76-fine-boring-with-p-and-q", ["G43 H1 Z50.", "G76 X30. Y20. Z-10. R3. Q0.2 P500 F100.", "G80"]),
        m("g73-peck", ["G73 X30. Y20. Z-10. R3. Q2. F100.", "G80"]),
        m("g83-with-p", ["G83 X30. Y20. Z-10. R3. Q2. P200 F100.", "G80"]),
        m("g74-left-tap", ["S300 M4", "G74 X30. Y20. Z-10. R3. F300.", "G80"]),
        m("g90-g1-x-z-f", ["G90 G1 X20. Z-5. F100."]),
        m("g94-g1-x-z-f", ["G94 G1 X20. Z-5. F100."]),
        m("g92-x-y", ["G92 X0. Y0.", "G0 X0. Y0.", "G1 X20. F100."]),
        m("g90-x-z-under-modal-g1", ["G1 Y20. F100.", "G90 X20. Z-5. F200."]),
        m("g18-arcs", ["G18", "G1 X10. Z10. F100.", "G2 X30. Z10. I10. K0.", "G17"]),
        m("four-digit-tool-of-a-magazine", ["T1001 M6", "G0 X10. Y10.", "G43 H1 Z50.", "G1 X20. F100."]),
        m("g97-s", ["G97 S1000 M3", "G1 X20. F100."]),
    ]


def item_3():
    cut = ["G1 X60. F200."]
    t = lambda name, dialect, blocks, expect, **more: Test("3-" + name, dialect, mill(dialect, *blocks), expect, **more)
    refuse = [("linuxcnc", "M428"), ("linuxcnc", "M429"), ("linuxcnc", "M430"), ("fanuc", "M128"), ("centroid", "M26"),
              ("fanuc", "M21"), ("fanuc", "M22"), ("fanuc", "M23")]
    many = ["M777", "G1 X60. F200.", "M777", "Y60.", "M777", "X20. M778"]

    return [t(f"{m}-{d}".lower(), d, [m] + cut, "refuse", says=m) for d, m in refuse] + [
        t("m428-beside-a-motion", "linuxcnc", ["M428 G1 X60. F200."], "refuse"),
        t("unknown-are-counted", "fanuc", many, "warn", says="M777|M778", once=True),
        t("unknown-are-counted-by-number", "fanuc", many, "warn", says=r"warning.*(\b[234]\b|two|three|four)"),
        t("unknown-are-counted-linuxcnc", "linuxcnc", ["M150", "M151"] + cut, "warn", says=r"warning.*(\b2\b|two)"),
        t("unknown-are-counted-perspektiva", "perspektiva", ["M77", "M77"] + cut, "warn", says=r"warning.*(\b[12]\b|two|one|twice)"),
        t("harmless-is-quiet", "fanuc", many, "pass", extra='\n[m_codes]\nharmless = ["M777", "M778"]\n', silent="warning.*M ?cod|M777|M778"),
        t("harmless-for-some", "fanuc", many, "warn", extra='\n[m_codes]\nharmless = ["M777"]\n', says="M778|warning[^\n]*(\\b1\\b|one)", silent="M777"),
        t("known-are-quiet", "fanuc", ["M3 S1000", "M8"] + cut + ["M9", "M5", "M4 S500", "M7", "M0", "M1"], "pass", silent="M ?code"),
        t("known-are-quiet-linuxcnc", "linuxcnc", ["M3 S1000", "M8"] + cut + ["M9", "M5", "M62 P1", "M64 P1"], "pass", silent="M ?code"),
        t("harmless-may-be-empty", "fanuc", cut, "pass", extra='\n[m_codes]\nharmless = []\n'),
    ]


def item_4():
    t = lambda name, blocks, expect, dialect="fanuc", **more: Test("4-" + name, dialect, ["G21 G90 G17 G54"] + blocks + ["M30"], expect, **more)
    mixed = ["G0 X10. Y10. Z50.", "G1 Z10 F200", "X20."]
    bare = ["G0 X10000 Y10000 Z50000", "G1 Z10000 F200", "X20000"]
    increments = ["--decimal", "increments"]
    millimetres = ["--decimal", "millimetres"]
    return [
        t("mixed", mixed, "refuse", says="decimal|point"),
        t("mixed-in-an-arc", ["G0 X10. Y10. Z50.", "G1 X20. F200.", "G2 X40. Y10. I10 J0."], "refuse"),
        t("mixed-in-a-cycle", ["G0 X10. Y10. Z50.", "G81 X20. Y20. Z-10. R3 F100.", "G80"], "refuse", says="decimal|point"),
        t("mixed-in-a-preset", ["G0 X10. Y10. Z50.", "G52 X5", "G0 X10. Y10. Z50.", "G1 X20. F100."], "refuse", says="decimal|point"),
        t("mixed-said-to-be-increments", mixed, "pass", args=increments, judged={"least": True}),
        t("mixed-said-to-be-millimetres", mixed, "pass", args=millimetres, judged={"least": False}),
        t("mixed-said-by-the-profile", mixed, "pass", extra='\n[program]\ndecimal = "millimetres"\n', judged={"least": False}),
        t("mixed-said-by-the-profile-increments", mixed, "pass", extra='\n[program]\ndecimal = "increments"\n', judged={"least": True}),
        t("option-goes-before-the-profile", mixed, "pass", args=millimetres, extra='\n[program]\ndecimal = "increments"\n', judged={"least": False}),
        t("only-bare-is-warned-with-its-count", bare, "warn", says=r"warning.*(\b5\b|five)"),
        t("only-bare-said-is-quiet", bare, "pass", args=increments, silent="point|decimal", judged={"least": True}),
        t("only-points-is-quiet", ["G0 X10. Y10. Z50.", "G1 Z10. F200.", "X20."], "pass", silent="decimal|without a point"),
        t("a-bare-zero-is-zero-either-way", ["G0 X0 Y0 Z50.", "G1 Z10. F200.", "X20. Y0", "G91 G28 Z0"], "pass"),
        t("counts-and-times-are-no-lengths", ["S1000 M3", "G0 X10. Y10. Z50.", "G4 P500", "G43 H1 Z50.", "G1 Z10. F200", "X20."], "pass", silent="without a point"),
        t("a-nonsense-value", mixed, "usage", args=["--decimal", "inches"], silent="unexpected argument"),
        t("mixed-means-nothing-elsewhere", mixed, "pass", "linuxcnc", silent="decimal|point"),
        t("mixed-means-nothing-elsewhere-centroid", mixed, "pass", "centroid", silent="decimal|point"),
    ]


def item_5():
    t = lambda name, dialect, lines, **more: Test("5-" + name, dialect, lines, "careful", judged={}, **more)
    s = "G21 G90 G17 G54"
    return [
        t("g53-then-rapid", "fanuc", [s, "G0 X10. Y10.", "G43 H1 Z20.", "G0 G53 Z0.", "X50. Y30.", "Z20.", "G1 Z5. F100.", "M30"]),
        t("g53-then-feed", "fanuc", [s, "G0 X10. Y10.", "G43 H1 Z20.", "G0 G53 Z0.", "G1 X50. Y30. F100.", "M30"]),
        t("bare-g43-then-feed", "fanuc", [s, "G0 X10. Y10. Z60.", "G43 H1", "G1 X100. F200.", "M30"]),
        t("bare-g49-then-feed", "fanuc", [s, "G0 X10. Y10.", "G43 H1 Z60.", "G49", "G1 X100. F200.", "M30"]),
        t("bare-h-then-feed", "fanuc", [s, "G0 X10. Y10.", "G43 H1 Z60.", "H2", "G1 X100. F200.", "M30"]),
        t("g28-then-feed", "fanuc", [s, "G0 X10. Y10.", "G43 H1 Z60.", "G91 G28 Z0.", "G90", "G1 X100. F200.", "M30"]),
        t("start-at-is-no-motion", "fanuc", [s, "G0 Z20.", "X30. Y30.", "G1 Z5. F100.", "M30"], start_at=START),
        t("start-at-then-feed", "fanuc", [s, "G1 X20. F200.", "M30"], start_at=START),
        t("start-at-linuxcnc", "linuxcnc", [s, "G0 Z20.", "X30. Y30.", "G1 Z5. F100.", "M30"], start_at=START),
        t("g52-then-feed", "fanuc", [s, "G0 X10. Y10. Z60.", "G52 X20.", "G1 Y30. F200.", "M30"]),
        t("g55-then-feed", "fanuc", [s, "G0 X10. Y10. Z60.", "G55", "G1 Y30. F200.", "M30"]),
        t("g10-then-feed", "fanuc", [s, "G0 X10. Y10. Z60.", "G10 L2 P1 X-400. Y-250. Z-390.", "G1 Y30. F200.", "M30"]),
        t("m6-then-rapid", "fanuc", [s, "G0 X10. Y10.", "G43 H1 Z60.", "G1 X20. F200.", "T2 M6", "G0 X5. Y5.", "G43 H2 Z30.", "G1 Z5. F100.", "M30"]),
        t("g53-centroid", "centroid", [s, "G0 X10. Y10.", "G43 H1 Z20.", "G0 G53 Z0.", "X50. Y30.", "Z20.", "G1 Z5. F100.", "M30"]),
        t("g53-sinumerik", "sinumerik", ["G71 G90 G17 G54", "G0 X10. Y10. Z20.", "G0 G53 Z0.", "X50. Y30.", "Z20.", "G1 Z5. F100.", "M30"]),
        t("g79-balt-system", "balt-system", ["G71 G90 G17", "G0 X10. Y10. Z20.", "G0 G79 Z0.", "X50. Y30.", "Z20.", "G1 Z5. F100.", "M30"]),
        t("cycle-behind-g53", "fanuc", [s, "G0 X10. Y10.", "G43 H1 Z20.", "G0 G53 Z0.", "G98 G81 X50. Y30. Z-5. R3. F100.", "X60.", "G80", "M30"]),
        t("g49-in-perspektiva", "perspektiva", [s, "G0 X10. Y10.", "G43 H1 Z60.", "G49", "G0 X50.", "G1 Y40. F200.", "M30"]),
    ]


def item_8():
    body = ["G21 G90 G17 G54", "G0 X10. Y10. Z50.", "G1 Z5. F200.", "X20."]
    lines = lambda *x: "\n".join(x) + "\n"
    t = lambda name, text, expect, dialect="fanuc", **more: Test("8-" + name, dialect, text, expect, **more)
    opened = lines("%", "O1", *body)
    cut = "\n".join(["%", "O1"] + body + ["X30."])
    strict = ["--strict"]
    return [
        t("opening-percent-no-end", opened, "warn"),
        t("opening-percent-no-end-strict", opened, "refuse", args=strict, says="cut|end|%"),
        t("opening-percent-no-end-linuxcnc", lines("%", *body), "warn", "linuxcnc"),
        t("opening-percent-no-end-perspektiva", lines("%1", *body), "warn", "perspektiva"),
        t("opening-percent-no-end-perspektiva-strict", lines("%1", *body), "refuse", "perspektiva", args=strict),
        t("number-ends-with-the-file", cut, "warn"),
        t("number-ends-with-the-file-no-percent", "\n".join(body + ["X30.0"]), "warn"),
        t("number-ends-with-the-file-strict", "\n".join(body + ["X30.0"]), "refuse", args=strict),
        t("number-ends-with-the-file-linuxcnc", "\n".join(body + ["G1 X30.0"]), "warn", "linuxcnc"),
        t("whole-program", lines("%", "O1", *body, "M30", "%"), "pass", silent="warning"),
        t("whole-program-strict", lines("%", "O1", *body, "M30", "%"), "pass", args=strict),
        t("m30-ends-without-line-end", "\n".join(body + ["M30"]), "pass", silent="warning"),
        t("opening-percent-with-m30", lines("%", "O1", *body, "M30"), "pass", silent="cut"),
        t("closing-percent-without-line-end", "\n".join(["%", "O1"] + body + ["M30", "%"]), "pass", silent="warning"),
        t("no-percent-no-end", lines(*body), "pass"),
        t("two-percents-in-front", lines("%", "%", "O1", *body, "M30", "%"), "careful", holds=not_as_it_was),
        t("two-percents-in-front-no-end", lines("%", "%", "O1", *body, "M30"), "careful", holds=not_as_it_was),
        t("two-percents-in-front-linuxcnc", lines("%", "%", *body, "M2", "%"), "careful", "linuxcnc", holds=not_as_it_was),
        t("two-percents-in-front-perspektiva", lines("%", "%1", *body, "M2", "%"), "careful", "perspektiva", holds=not_as_it_was),
        t("code-behind-a-closing-percent", lines("%", "O1", *body, "M30", "%", "O2", *body, "G1 X77.", "M30"), "careful", holds=moved_somewhere("G1 X77.")),
        t("code-behind-a-closing-percent-no-m30", lines("%", "O1", *body, "%", *body, "G1 X77."), "careful", holds=moved_somewhere("G1 X77.")),
        t("code-behind-a-closing-percent-linuxcnc", lines("%", *body, "%", "G1 X77.", "M2"), "careful", "linuxcnc", holds=moved_somewhere("G1 X77.")),
        t("blank-lines-behind-a-closing-percent", lines("%", "O1", *body, "M30", "%", "", ""), "pass", silent="warning"),
    ]


def item_10():
    s = "G21 G90 G17 G54"
    kept = [s, "G0 X10. Y10. Z50.", "G1 Z30. F200.", "T2 M6", "G1 X20. F200.", "M30"]
    named = [s, "G0 X10. Y10. Z50.", "T2 M6", "G0 X10. Y10. Z50.", "G1 X20. F200.", "M30"]
    t = lambda name, lines, expect, dialect="fanuc", **more: Test("10-" + name, dialect, lines, expect, **more)
    keeps = lambda axes: f'\n[program]\ntool_change = {{ keeps = "{axes}" }}\n'
    place = [f"\n[program]\ntool_change = {x}\n" for x in
             ("[-10, -10, -20]", "{ position_mm = [-10, -10, -20] }", "{ position = [-10, -10, -20] }", "{ at_mm = [-10, -10, -20] }", "{ X = -10, Y = -10, Z = -20 }")]
    out = [t("m6-unsaid-names-m6", kept, "refuse", says=r"\bM6\b", silent="start-at")]
    for dialect in ("fanuc", "linuxcnc", "centroid", "perspektiva"):
        out += [
            t(f"m6-unsaid-{dialect}", kept, "refuse", dialect, says=r"\bM6\b"),
            t(f"m6-keeps-xyz-{dialect}", kept, "pass", dialect, extra=keeps("XYZ"), holds=moved_somewhere("G1 X20. F200.")),
        ]
    return out + [
        t("m6-keeps-xy-z-unknown", kept, "refuse", extra=keeps("XY"), says=r"\bM6\b"),
        t("m6-keeps-z-xy-unknown", kept, "refuse", extra=keeps("Z"), says=r"\bM6\b"),
        t("m6-at-a-position", kept, "pass", either=place, holds=moved_somewhere("G1 X20. F200.")),
        t("m6-keeps-nonsense", named, "usage", extra=keeps("XQ"), silent="unknown key `program`"),
        t("m6-named-after", named, "pass", judged={}),
        t("m6-named-after-keeps", named, "pass", extra=keeps("XYZ"), judged={"change": "none"}),
        t("m6-keeps-xy-z-named", [s, "G0 X10. Y10. Z50.", "T2 M6", "G0 Z50.", "G1 X20. F200.", "M30"], "pass", extra=keeps("XY")),
    ]


def item_11():
    t = lambda name, dialect, blocks, expect, **more: Test("11-" + name, dialect, mill(dialect, *blocks), expect, **more)
    raw = lambda name, dialect, lines, expect, **more: Test("11-" + name, dialect, lines, expect, **more)
    cut = ["G1 X60. F200.", "G1 Y40. F200."]
    s = "G21 G90 G17 G54"

    def six_decimals(text, output):
        words = [v for a, v in axis_words(output) if "." in v]
        most = max((len(v.split(".")[1]) for v in words), default=0)
        return "" if most >= 5 else f"at most {most} decimals of an inch are written"

    def first_two(text, output):
        return "" if output.split("\n")[:2] == text.split("\n")[:2] else f"the file begins with {output.split(chr(10))[:3]}"

    path_head = ["%_N_PART_MPF", ";$PATH=/_N_MPF_DIR", "G71 G90 G17 G54", "G0 X10 Y10 Z50", "G1 X60 F200", "M30"]
    return [
        # LinuxCNC
        raw("g43-h0-is-the-tool-in-the-spindle", "linuxcnc", [s, "T1 M6", "G0 X10. Y10.", "G43 H0 Z50.", "G1 Z5. F200.", "X60.", "M2"], "pass", like=("G43 H0", "G43 H1")),
        raw("g43-h0-with-no-tool-known", "linuxcnc", [s, "G0 X10. Y10.", "G43 H0 Z50.", "G1 Z5. F200.", "X60.", "M2"], "refuse", says="H0|tool|length"),
        raw("inch-six-decimals", "linuxcnc", ["G20 G90 G17 G54", "G0 X0.4 Y0.4 Z2.", "G1 Z0.2 F20.", "X2.", "Y1.5", "M2"], "pass", holds=six_decimals),
        t("l0-is-an-error-of-the-control", "linuxcnc", ["G81 X20. Y20. Z-5. R3. L0 F100.", "X30.", "G80"], "refuse"),
        t("k-repeats-nothing", "linuxcnc", ["G81 X20. Y20. Z-5. R3. K2 F100.", "X30.", "G80"], "refuse"),
        t("l2-repeats", "linuxcnc", ["G91 G81 X5. Z-8. R-40. L2 F100.", "G90 G80"], "careful"),
        # Haas and others under `fanuc`
        t("g110-is-a-work-offset", "fanuc", ["G110", "G0 X10. Y10. Z50."] + cut, "refuse"),
        t("g113-is-a-work-offset", "fanuc", ["G113", "G0 X10. Y10. Z50."] + cut, "refuse"),
        t("g112-is-a-work-offset", "fanuc", ["G112", "G0 X10. Y10. Z50."] + cut, "refuse"),
        t("g129-is-a-work-offset", "fanuc", ["G129", "G0 X10. Y10. Z50."] + cut, "refuse"),
        t("g150-is-a-pocket", "fanuc", ["G150 P1001 X30. Y30. Z-5. Q1. R3. I2. K0.2 G41 D1 F100."], "refuse"),
        t("g150-alone", "fanuc", ["G150"] + cut, "refuse"),
        t("m21-mirror", "fanuc", ["M21"] + cut + ["M23"], "refuse"),
        raw("neither-g20-nor-g21", "fanuc", mill("fanuc", *cut, units=False), "warn", says="G20|G21|inch|unit"),
        t("g21-is-quiet", "fanuc", cut, "pass", silent="G20|G21|inch"),
        t("k0-defines-only", "fanuc", ["G81 X20. Y20. Z-5. R3. K0 F100.", "X30.", "Y40.", "G80"], "careful", judged={}),
        t("l0-defines-only", "fanuc", ["G81 X20. Y20. Z-5. R3. L0 F100.", "X30.", "Y40.", "G80"], "careful", judged={}),
        t("k3-repeats", "fanuc", ["G0 X10. Y10. Z50.", "G91 G98 G81 X5. Z-8. R-40. K3 F100.", "G90 G80", "G0 X10. Y10. Z50."], "careful", judged={}),
        # Balt-System
        t("g4-x-is-no-time", "balt-system", ["G1 Z20. F200.", "G4 X60.", "G1 Y40. F200."], "careful", holds=moved_somewhere("G4 X60.")),
        t("g4-beside-a-motion", "balt-system", ["G1 Z20. F200.", "G1 G4 X60.", "G1 Y40. F200."], "careful", holds=moved_somewhere("G1 G4 X60.")),
        t("tmr-and-g4", "balt-system", ["(TMR=2.5)", "G1 Z20. F200.", "G4"] + cut, "pass"),
        t("tmr-without-brackets", "balt-system", ["TMR=2.5", "G1 Z20. F200.", "G4"] + cut, "careful"),
        # Perspektiva, GOST 20999-83
        t("g63-taps", "perspektiva", ["S300 M3", "G63 Z-10. F300."], "refuse"),
        t("g63-holds-for-one-block", "perspektiva", ["G63"] + cut, "refuse"),
        t("g49-is-an-offset", "perspektiva", ["G43 H1 Z50.", "G1 X20. F200.", "G49", "G0 X10. Y10. Z60."] + cut, "refuse"),
        t("g40-may-cancel-the-length", "perspektiva", ["G43 H1 Z50.", "G1 X20. F200.", "G40", "G0 X10. Y10. Z60.", "G1 Z30. F200."], "refuse"),
        t("g40-alone", "perspektiva", ["G40"] + cut, "pass"),
        # Sinumerik
        raw("path-line-stays-second", "sinumerik", path_head, "pass", holds=first_two),
        t("cycle832-with-a-second-argument", "sinumerik", ["CYCLE832(0.05,112101)"] + cut, "refuse"),
        t("cycle832-with-three-arguments", "sinumerik", ["CYCLE832(0.05,3,1)"] + cut, "refuse"),
        t("cycle832-with-one-argument", "sinumerik", ["CYCLE832(0.05)"] + cut, "pass"),
        t("t-may-change-at-once", "sinumerik", ["G1 X20. F200.", "T1"] + cut, "refuse"),
        t("t-by-name", "sinumerik", ["G1 X20. F200.", 'T="MILL10"'] + cut, "refuse"),
        raw("g54-not-written", "sinumerik", ["G71 G90 G17", "G0 X10. Y10. Z50."] + cut + ["M30"], "careful", says="G54|offset"),
        t("g54-written", "sinumerik", cut, "pass", silent="G54"),
        # Centroid
        t("colon-begins-a-comment", "centroid", [":G1 X99. IS TEXT"] + cut, "pass", holds=keeps_block(":G1 X99. IS TEXT")),
        t("colon-text", "centroid", [":THIS IS TEXT"] + cut, "pass", holds=keeps_block(":THIS IS TEXT")),
        t("colon-is-no-block", "centroid", [":10 G0 X99."] + cut, "pass", holds=keeps_block(":10 G0 X99.")),
    ]
