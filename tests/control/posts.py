"""Programs as many posts write them, in LinuxCNC's words, for judges that need no path of their own: a kind each."""

import math

LENGTHS_MM = {1: 80.0, 2: 65.5, 3: 101.25, 4: 40.0}
ZEROS_MM = {"G54": (120.0, 110.0, 60.0), "G55": (240.0, 115.0, 62.5), "G56": (150.0, 230.0, 58.0)}
CLEAR = 25.0


class Post:
    """Lines of a program."""

    def __init__(self, chance, mode=None, tool=1, head="G21 G90 G17 G40 G49 G80 G94"):
        self.chance, self.lines = chance, []
        self.mode = chance.choice(["G61", "G61.1", "G64", "G64 P0.01", "G64 P0.05 Q0.02"]) if mode is None else mode
        self.say("%", f"({chance.choice(['PLATE 4711', 'OP 10', 'MILL'])})", f"{head} G54", self.mode)
        self.load(tool, chance.choice(["G54", "G55", "G56"]))

    def say(self, *lines):
        self.lines += lines

    def load(self, tool, offset=None, spindle=None):
        """A tool, its length, its spindle; all axes unknown until they are named."""
        speed = self.chance.randrange(1000, 9000, 100)
        self.say(f"T{tool} M6", f"{spindle or self.chance.choice(['M3', 'M3', 'M4'])} S{speed}")
        if offset:
            self.say(offset)
        self.say(f"G0 X{self.any()} Y{self.any()}", f"G43 H{tool} Z{CLEAR:.3f}", self.chance.choice(["M8", "M7", "M8"]))

    def any(self, low=5.0, high=95.0):
        return f"{self.chance.uniform(low, high):.3f}"

    def down(self, z=-2.0, x=None, y=None):
        self.say(f"G0 X{x or self.any()} Y{y or self.any()}", "G0 Z2.000")
        self.say(f"G1 Z{z:.3f} F{self.chance.randrange(200, 900, 50)}")

    def up(self):
        self.say(f"G0 Z{CLEAR:.3f}")

    def lines_at(self, count, f=None):
        for k in range(count):
            words = self.chance.choice(["X{} Y{}", "X{}", "Y{}", "X{} Y{}"])
            words = words.format(*(self.any() for _ in range(words.count("{}"))))
            self.say(("G1 " if k == 0 else "") + words + (f" F{f or 2500}" if k == 0 else ""))

    def text(self):
        self.say("M9", "M5", f"G0 Z{CLEAR + 15:.3f}", "M2", "%")
        return ("\n".join(self.lines) + "\n").encode()


def plate(post):
    """A contour on three depths."""
    for depth in (-1.0, -2.0, -3.0):
        post.down(depth)
        post.lines_at(8)
        post.up()


def slots(post):
    """Lines and half circles."""
    post.down(-1.5, "20.000", "20.000")
    for _ in range(3):
        r = post.chance.randrange(6, 18)
        post.say("G1 X80.000 F2000", f"G3 X80.000 Y{20 + 2 * r}.000 I0 J{r}.000", "G1 X20.000")
        post.say(f"G3 X20.000 Y20.000 I0 J-{r}.000")
    post.up()


def helix(post):
    """A pocket by a helix, feeds up at last."""
    post.down(0.5, "60.000", "50.000")
    for turn in range(1, 5):
        post.say(f"G3 X60.000 Y50.000 Z{0.5 - 0.8 * turn:.3f} I-10.000 J0 F1800")
    post.say("G3 I-10.000 J0", "G1 Z1.000")
    post.up()


def other_planes(post):
    """Arcs in XZ and YZ."""
    post.down(-1.0, "20.000", "30.000")
    for k in range(3):
        post.say("G18", f"G3 X{40 + 20 * k}.000 Z-1.000 I10.000 K0 F1500", "G19", "G2 Y36.000 Z-1.000 J3.000 K0")
        post.say("G17", f"G1 X{40 + 20 * k}.000 Y30.000")
    post.up()


def raster(post):
    """Lines forth and back over a dome, without words that do not change."""
    post.down(0.0, "10.000", "10.000")
    for row in range(4):
        xs = range(10, 75, 5) if row % 2 == 0 else range(70, 5, -5)
        post.say(f"G1 Y{10 + 4 * row}.000 F3000")
        for x in xs:
            post.say(f"X{x}.000 Z{4 - ((x - 40) ** 2 + (4 * row - 8) ** 2) / 300:.3f}")
    post.up()


def spline(post):
    """Short segments."""
    post.down(-1.0, "5.000", "50.000")
    size = post.chance.uniform(3, 12)
    for k in range(1, 60):
        feed = " F2400" if k == 1 else ""
        post.say(f"G1 X{5 + 1.2 * k:.3f} Y{50 + size * math.sin(k / 6):.3f} Z{-1 + 0.3 * math.sin(k / 9):.3f}{feed}")
    post.up()


def holes(post):
    """G81 at places, back to where it started."""
    post.say(f"G98 G81 X{post.any()} Y{post.any()} Z-8.000 R2.000 F300")
    for _ in range(7):
        post.say(post.chance.choice([f"X{post.any()} Y{post.any()}", f"X{post.any()}", f"Y{post.any()}"]))
    post.say("G80")
    post.up()


def pecks(post):
    """G83 down to R, and a second pattern at another depth."""
    post.say("G0 Z8.000", f"G99 G83 X{post.any()} Y{post.any()} Z-12.000 R2.000 Q4.000 F250")
    for k in range(6):
        post.say(f"X{post.any()} Y{post.any()}" + (" Z-9.000" if k == 3 else ""))
    post.say("G80", "G0 Z20.000", f"G98 G82 X{post.any()} Y{post.any()} Z-3.000 R1.000 P0.1 F180")
    post.say(f"X{post.any()}", "G80")
    post.up()


def row_of_holes(post):
    """A cycle that repeats under G91."""
    post.say("G0 X10.000 Y10.000", "G91 G98 G81 X5.000 Y2.000 Z-7.000 R-22.000 F300 L4", "X-3.000 Y8.000 L2", "G80 G90")
    post.up()


def tools(post):
    """Three tools, the next one called early."""
    for tool, nxt in ((2, 3), (3, 4), (4, 1)):
        post.down(-1.0)
        post.lines_at(4)
        post.say(f"G0 Z{CLEAR:.3f}", "M9", "M5")
        post.load(tool)
        post.say(f"T{nxt}")
    post.down(-2.5)
    post.lines_at(4)
    post.up()


def zeros(post):
    """The same part at several work offsets."""
    for name in ("G54", "G55", "G56", "G54"):
        post.say(f"G0 Z{CLEAR:.3f}", name, f"G0 X{post.any()} Y{post.any()}", f"Z{CLEAR:.3f}")
        post.down(-1.0)
        post.lines_at(4)
        post.up()


def increments(post):
    """G91 for a part of it, arcs too."""
    for _ in range(3):
        post.down(-1.0, "30.000", "30.000")
        post.say("G91", "G1 X12.5 F2000", "Y7.25", "X-3.125 Y4.0", "G2 X4.000 Y0 I2.000 J0", "G1 Z-0.5 F300")
        post.say("X6.0 F2000", "Y-4.5", "G90")
        post.lines_at(2)
        post.up()


def inches(post):
    """A part of it under G20."""
    post.down(-1.0)
    post.lines_at(3)
    post.say("G20", "G1 X1.2345 F80", "Y2.1", "G3 X1.6345 Y2.1 I0.2 J0", "G1 X0.75 Y0.8", "Z-0.0625 F20", "X1.5", "G21")
    post.lines_at(3)
    post.up()


def inverse_time(post):
    """G93 for a part of it."""
    post.down(-1.0)
    post.lines_at(3)
    post.say("G93", *(f"G1 X{post.any()} Y{post.any()} F{post.chance.randrange(8, 40)}" for _ in range(6)))
    post.say("G94", "F1500")
    post.lines_at(3)
    post.up()


def cutter(post):
    """Cutter compensation between two parts without."""
    post.down(-1.0)
    post.lines_at(3)
    post.up()
    post.down(-1.0, "10.000", "5.000")
    post.say("G41.1 D6.0", "G1 X20.000 Y10.000 F1500", "Y60.000", "X70.000", "Y10.000", "X20.000", "G40")
    post.say("G1 X5.000 Y5.000")
    post.lines_at(2)
    post.up()


def subprogram(post):
    """A contour called at three depths."""
    post.lines[1:1] = ["O100 sub", "G1 Z#1 F400", "G91 G1 X20.000 F2000", "Y15.000", "X-20.000", "Y-15.000", "G90"]
    post.lines.insert(8, "O100 endsub")
    for depth in (-1, -2, -3):
        post.say("G0 X20.000 Y20.000", "G0 Z2.000", f"O100 call [{depth}]")
        post.lines_at(2)
        post.up()


def shifted(post):
    """G92 shifts the zero for a part of it."""
    post.down(-1.0, "30.000", "40.000")
    post.lines_at(2)
    post.up()
    post.say("G0 X30.000 Y40.000", "G92 X0 Y0")
    post.say("G0 Z2.000", "G1 Z-1.000 F400", "G1 X20.000 F2000", "Y15.000", "X0", "Y0", f"G0 Z{CLEAR:.3f}", "G92.1")
    post.down(-2.0)
    post.lines_at(3)
    post.up()


def numbered(post):
    """Line numbers, comments, blank lines, small letters, block skip off."""
    post.down(-1.0)
    post.lines_at(5)
    post.say("(second)", "", "g1 x10.5 y 20.25 f1800", "X [5 + 10] Y[2*20]", "; a comment", "G01X30.Y31.5")
    post.lines_at(4)
    post.up()
    post.lines = [f"N{10 * k} {line}" if line and line[0] in "GXYMTg" else line for k, line in enumerate(post.lines)]


def switches(post):
    """Speeds, coolant and path modes that change on the way."""
    post.down(-1.0)
    for words in ("S1500", "M9", "G61", "M7", "G64 P0.02", "S4200 M4", "M8", "G64", "M5", "M3", "F1234", "G61.1"):
        post.say(words)
        post.lines_at(2, f=post.chance.randrange(600, 3000, 10))
    post.up()


def stops(post):
    """Dwells, stops, messages, exact stop for some corners."""
    post.down(-1.0)
    for words in ("G4 P0.05", "M1", "(MSG, turn the part)", "G4 P0.1", "M0"):
        post.lines_at(2)
        post.say(words)
    post.up()


def machine_places(post):
    """G53 and G28 between the parts."""
    post.down(-1.0)
    post.lines_at(3)
    post.up()
    post.say("G53 G0 Z190.000", "G53 G0 X200.000 Y200.000", f"G0 X{post.any()} Y{post.any()}", f"G0 Z{CLEAR:.3f}")
    post.down(-2.0)
    post.lines_at(3)
    post.up()
    post.say("G28 Z30.000", f"G0 X{post.any()} Y{post.any()}", f"G0 Z{CLEAR:.3f}")
    post.down(-1.5)
    post.lines_at(3)
    post.up()


def radii(post):
    """Arcs by radius, and F on every line."""
    post.down(-1.0, "20.000", "20.000")
    for k in range(5):
        post.say(f"G2 X{30 + 10 * k}.000 Y20.000 R{7 + k}.000 F{900 + 100 * k}")
        post.say(f"G1 X{30 + 10 * k}.000 Y20.000 F{2000 - 50 * k}")
    post.up()


def ramps(post):
    """Ways down along a zigzag, and up again under feed."""
    post.down(1.0, "20.000", "20.000")
    for k in range(5):
        post.say(f"G1 X{70 if k % 2 == 0 else 20}.000 Z{0.5 - 0.5 * k:.3f} F1200")
    post.say("X20.000", "Z-1.200", "Y60.000", "Z-0.600 X30.000", "Y20.000")
    post.up()


KINDS = {
    kind.__name__: kind
    for kind in (plate, slots, helix, other_planes, raster, spline, holes, pecks, row_of_holes, tools, zeros)
    + (increments, inches, inverse_time, cutter, subprogram, shifted, numbered, switches, stops)
    + (machine_places, radii, ramps)
}


def make(kind, chance, mode=None):
    """Text of a program."""
    post = Post(chance, mode)
    KINDS[kind](post)
    return post.text()
