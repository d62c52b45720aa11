"""One reader per dialect."""


import rs274
from core import Invalid
from fanuc import FanucFlow
from iso import Iso
from generator import Mill
from generator_lathe import LatheProgram
from generator_ngc_lathe import NgcLatheProgram
from generator_okuma import OkumaMill
from generator_siemens import SiemensMill
from generator_siemens_turn import SiemensTurnProgram
from lathe import Lathe
from ngc import NgcFlow, PlainFlow
from okuma import Okuma
from siemens import Siemens, SiemensTurn


class Fanuc(FanucFlow, Iso):
    pass


class Ngc(NgcFlow, Iso):
    pass


class Plain(PlainFlow, Iso):
    pass


ISO = {"fanuc": Fanuc, "haas": Fanuc, "mitsubishi": Fanuc, "linuxcnc": Ngc, "grbl": Ngc, "mach": Ngc,
       "centroid": Plain, "perspektiva": Plain, "balt-system": Plain}


SYSTEMS = {"fanuc-lathe": "A", "fanuc-lathe-b": "B"}
LATHES = ("fanuc-lathe", "fanuc-lathe-b", "sinumerik-turn", "linuxcnc-lathe")


def read_by_rs274(text):
    """A lathe's program by LinuxCNC's own interpreter; its Y stands still."""
    events, said = rs274.read(text, turning=True)
    if events is None:
        raise Invalid(f"rs274: {said}")
    return [e for e in events if not isinstance(e, tuple)]


def read(dialect, text, include=None):
    """The motions of a program, as its control makes them."""
    if dialect in ISO:
        return ISO[dialect](dialect).run(text)
    if dialect == "okuma":
        return Okuma().run(text)
    if dialect == "linuxcnc-lathe":
        return read_by_rs274(text)
    if dialect in SYSTEMS:
        return Lathe(SYSTEMS[dialect]).run(text)
    return {"sinumerik": Siemens, "sinumerik-turn": SiemensTurn}[dialect](include).run(text)


def generate(dialect, rng, include):
    """A random program; files that it calls go into the folder `include`."""
    if dialect in ISO:
        return Mill(rng, dialect).program()
    if dialect in SYSTEMS:
        return LatheProgram(rng, SYSTEMS[dialect]).program()
    return {"sinumerik": SiemensMill, "okuma": OkumaMill, "sinumerik-turn": SiemensTurnProgram,
            "linuxcnc-lathe": NgcLatheProgram}[dialect](rng, include).program()


def profile_offsets(dialect, plain, numbered):
    """The work offsets by the names that the dialect has for them."""
    if dialect == "sinumerik":
        return {**{k: v for k, v in plain.items() if k < "G58"}, "G505": (12, -14, 16), "G599": (-30, 22, 5)}
    if dialect == "okuma":
        return {"G15H1": plain["G54"], "G15H2": plain["G55"], "G15H3": plain["G56"]}
    return {**plain, **(numbered if dialect in ("fanuc", "haas", "mitsubishi") else {})}


DIALECTS = list(ISO) + ["sinumerik", "okuma", "fanuc-lathe", "fanuc-lathe-b", "sinumerik-turn",
                        "linuxcnc-lathe"]
FLAGS = {d: ["--decimal", "increments"] for d in ("fanuc", "haas", "mitsubishi", "okuma", "fanuc-lathe", "fanuc-lathe-b")}
