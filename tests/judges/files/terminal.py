"""Terminal: nothing that others wrote reaches it with control, escape or bidirectional characters.

Both outputs are a pseudo-terminal in raw mode, so that what is read here is what a terminal would have to obey. Each hostile text ends
with a mark, `Zq` and a number. Wrong is:

  - with `--color never`: any C0 control but newline (and carriage return where a bar is drawn), DEL, C1 control or bidirectional
    character, and bytes that are no UTF-8 (a terminal may take 0x80 to 0x9F for C1 controls);
  - with `--color always`: the same, what is left when the command's own sequences for colours are taken out; and any hostile text as it was.

The NC program on standard output is the exception: its bytes are kept, and the same as into a file.
"""

import fcntl
import os
import pty
import random
import re
import select
import shutil
import struct
import termios
import time
import tty

from runner import REPOSITORY, first_line, profile, program, read, write

SAMPLES = os.path.join(REPOSITORY, "samples")
TEXTS = ["\x1b[2JZq0", "\x1b]0;Zq1\x07", "\x1b[31;1mZq2", "\x1b[8mZq3", "\x07Zq4", "\x08\x08Zq5", "\x0b\x0cZq6", "\x0eZq7", "\x7fZq8", "\u009b2JZq9",
         "\u0085\u009d0;Zq10", "\u202eZq11", "\u2066Zq12\u2069", "\u202a\u202b\u202c\u202dZq13", "\u2067\u2068Zq14", "\u200e\u200f\u061cZq15",
         "\x01\x02\x1cZq16", "\x1bcZq17", "\x1bP+q\x1b\\Zq18"]
BIDI = set("\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
COLOURS = re.compile(r"\x1b\[[0-9;]*m")
BAR = re.compile(r"\x1b\[[0-9;?]*[ABCDGHJKhlm]")


def on_terminal(judge, args, cwd, data=None, program_apart=False, timeout=60):
    """Runs with standard output and error on a pseudo-terminal; returns status, what reached the terminal, and the program."""
    master, slave = pty.openpty()
    tty.setraw(slave)
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 200, 0, 0))
    apart = open(os.path.join(judge.work, "apart"), "w+b")
    given = None
    if data is not None:
        given = open(os.path.join(judge.work, "given"), "w+b")
        given.write(data)
        given.flush()
        given.seek(0)
    child = judge.start(args, cwd=cwd, stdin=given or slave, stdout=apart if program_apart else slave, stderr=slave,
                        env=judge.environment(COLUMNS=200))
    os.close(slave)
    seen, end = b"", time.monotonic() + timeout
    while time.monotonic() < end:
        ready, _, _ = select.select([master], [], [], 0.1)
        if ready:
            try:
                piece = os.read(master, 65536)
            except OSError:
                break
            if not piece:
                break
            seen += piece
    child.kill()
    status = child.wait()
    os.close(master)
    apart.seek(0)
    kept = apart.read()
    apart.close()
    if given:
        given.close()
    return status, seen, kept


def raw(seen, hostile, own=COLOURS, bar=False):
    """What reached the terminal that must not, or an empty list."""
    found = [t for t in hostile if t.encode("utf-8", "surrogateescape") in seen]
    try:
        text = seen.decode("utf-8")
    except UnicodeDecodeError as error:
        return found + ["no UTF-8: %r" % seen[error.start:error.start + 8]]
    text = own.sub("", text)
    for index, character in enumerate(text):
        code = ord(character)
        if character == "\n" or (character == "\r" and (bar or text[index + 1:index + 2] == "\n")):
            continue
        if code < 0x20 and character == "\t":
            continue
        if code < 0x20 or 0x7F <= code <= 0x9F or character in BIDI:
            found.append("%r in %r" % (character, text[max(0, index - 20):index + 12]))
            break
    return found


def ask(judge, name, case, args, cwd, hostile, data=None, program_apart=True, bar=False, files=(), must_show=False):
    for colour in ("never", "always"):
        command = list(args) + ["--color", colour]
        status, seen, _ = on_terminal(judge, command, cwd, data, program_apart)
        found = raw(seen, hostile, BAR if bar else COLOURS, bar)
        judge.judge(name, found, "%s, --color %s" % (case, colour), "exit status %d, raw on the terminal: %s" % (status, found[:2]),
                    "escaped or left out", command, list(files) + [("terminal", seen)])
        if must_show and colour == "never":
            shown = any(re.search(r"Zq\d+", t).group(0).encode() in seen for t in hostile)
            if not shown:
                judge.note("terminal: nothing of the hostile text was shown in: %s" % case)


def chosen(judge):
    """All hostile texts, or for a small count a few."""
    return TEXTS if judge.count >= 20 else TEXTS[::7]


def toml(text):
    """A basic TOML string of any text."""
    return '"' + "".join(c if c.isprintable() and c not in '"\\' else "\\u%04x" % ord(c) for c in text) + '"'


def run(judge):
    folder = judge.folder("terminal")
    mill = profile(folder)
    text = program(random.Random(1), 5)
    plain = read(mill).decode()
    write(os.path.join(folder, "part.nc"), text)
    reference = judge.run(["part.nc", "-m", "mill.toml"], cwd=folder).out
    name = "program text in messages"
    for number, hostile in enumerate(chosen(judge)):
        block = hostile.encode()
        for case, bad in (("comment in the refused block", b"G1 X60. G777 (" + block + b")\n"), ("code that is unknown", b"G1 X60. " + block + b"\n"),
                          ("unclosed comment", b"G1 X60. (" + block + b"\n"), ("outside the volume", b"G1 X99999. (" + block + b")\n"),
                          ("name of a variable", b"G1 X#<" + block + b">\n"), ("subprogram that is not there", b"M98 <" + block + b">\n"),
                          ("message", b"(MSG, " + block + b")\nG1 X60. G777\n"), ("word", b"G1 X" + block + b"5.\n")):
            path = write(os.path.join(folder, "bad.nc"), text.replace(b"G0 Z50.\nM30", bad + b"G0 Z50.\nM30"))
            for dialect in ("fanuc", "linuxcnc") if number % 6 == 0 else ("fanuc",):
                ask(judge, name, "%s, %r, %s" % (case, hostile, dialect), ["bad.nc", "-m", "mill.toml", "-d", dialect], folder, [hostile], files=[path])
    for case, bytes_ in (("cp1251 and C1 bytes", b"G1 X60. G777 (\x9b2J\xcf\xf0\xee\x85)\n"), ("cut UTF-8", b"G1 X60. G777 (\xe2\x80)\n")):
        path = write(os.path.join(folder, "bad.nc"), text.replace(b"G0 Z50.\nM30", bytes_ + b"G0 Z50.\nM30"))
        ask(judge, name, case, ["bad.nc", "-m", "mill.toml"], folder, [], files=[path])
    name = "program text in reports of check"
    for hostile in chosen(judge):
        write(os.path.join(folder, "one.nc"), text.replace(b"M30", ("(%s)\nM30" % hostile).encode()))
        write(os.path.join(folder, "two.nc"), text.replace(b"X0", b"X3").replace(b"M30", ("(%s)\nM8\nM30" % hostile).encode()))
        ask(judge, name, "%r" % hostile, ["check", "one.nc", "two.nc", "-m", "mill.toml"], folder, [hostile], program_apart=False)
        ask(judge, name, "%r, --json" % hostile, ["check", "one.nc", "two.nc", "-m", "mill.toml", "--json"], folder, [hostile], program_apart=False)
    name = "names of files"
    for hostile in chosen(judge):
        part = hostile.replace("/", "") + ".nc"
        for base in (part, "good" + part):
            write(os.path.join(folder, "named", base), text if base != part else text.replace(b"G0 Z50.\nM30", b"G777\nM30"))
        profile(os.path.join(folder, "named"), name=hostile + ".toml")
        for case, args in (("refused program", ["named/" + part, "-m", "mill.toml"]), ("program that is not there", ["named/x" + part, "-m", "mill.toml"]),
                           ("output that cannot be", ["part.nc", "-m", "mill.toml", "-o", "nowhere/" + part]), ("profile that is not there", ["part.nc", "-m", "x" + part]),
                           ("include folder", ["named/" + part, "-m", "mill.toml", "--include", "x" + part]), ("dialect", ["part.nc", "-m", "mill.toml", "-d", hostile]),
                           ("dialect table", ["part.nc", "-m", "mill.toml", "-d", hostile + ".toml"]), ("grammar check", ["grammar", "check", "x" + part]),
                           ("verbose", ["named/good" + part, "-m", "mill.toml", "-v", "-v"]), ("batch", ["batch", "named", "-m", "mill.toml", "-O", "outs" + hostile, "--force"]),
                           ("results", ["batch", "named", "-m", "mill.toml", "-O", "outs2", "--results", "-"]),
                           ("plan", ["batch", "plan", "named", "-m", "mill.toml", "-O", "outs3", "--manifest", "nowhere/" + part]),
                           ("run", ["batch", "run", "--manifest", "x" + part]), ("profile check", ["profile", "check", "named/" + hostile + ".toml"]),
                           ("profile show", ["profile", "show", "named/" + hostile + ".toml"]), ("predict", ["predict", "x" + part, "-m", "mill.toml"]),
                           ("diagnose", ["diagnose", "x" + part, "-m", "mill.toml"]), ("calibrate", ["calibrate", "interferometer", "named/" + part, "-m", "mill.toml"]),
                           ("map", ["map", "-m", "mill.toml", "--grid", "2x2x2", "--json", "nowhere/" + part])):
            ask(judge, name, "%s, %r" % (case, hostile), args, folder, [hostile], program_apart=not args[0] in ("batch", "profile", "grammar"),
                bar=args[0] == "batch" and args[1] != "plan")
        shutil.rmtree(os.path.join(folder, "named"))
    name = "values on the command line"
    for hostile in chosen(judge):
        for args in (["--tolerance", hostile], ["--work-offset", hostile], ["--tool", hostile], ["--set", hostile], ["--start-at", hostile], ["--at", hostile + "=1"],
                     ["--engine", hostile], ["--outside", hostile], ["--" + hostile], ["--progress", hostile]):
            ask(judge, name, "%s %r" % (args[0][:9], hostile), ["part.nc", "-m", "mill.toml"] + args, folder, [hostile])
        ask(judge, name, "command %r" % hostile, ["profile", hostile], folder, [hostile])
    name = "names in profiles"
    for hostile in chosen(judge):
        for case, new in (("machine", plain.replace('"Judge\'s mill"', toml(hostile))), ("instrument", plain.replace('"made up"', toml(hostile))),
                          ("date", plain.replace('"2026-05-15"', toml(hostile))), ("control", plain.replace('"fanuc"', toml(hostile))),
                          ("chain", plain.replace('"[w X Y b Z t]"', toml("[w X Y b Z t %s]" % hostile))), ("unknown key", toml(hostile) + " = 1\n" + plain),
                          ("table file", plain.replace('"x.csv"', toml(hostile + ".csv"))), ("tool", plain.replace("H2 =", toml(hostile) + " =")),
                          ("offset", plain.replace("G54 =", toml(hostile) + " =")), ("effect", plain + "\n[[effect]]\nid = %s\n" % toml(hostile)),
                          ("not TOML", "format = 1 # " + hostile + "\nname = ]" + hostile)):
            write(os.path.join(folder, "own.toml"), new)
            for args in (["part.nc", "-m", "own.toml", "-v"], ["profile", "show", "own.toml"], ["profile", "check", "own.toml"],
                         ["map", "-m", "own.toml", "--grid", "2x2x2"], ["budget", "-m", "own.toml", "--grid", "2x2x2"], ["check", "part.nc", "part.nc", "-m", "own.toml"]):
                if case not in ("machine", "instrument", "date") and args[0] in ("map", "budget", "check"):
                    continue
                ask(judge, name, "%s, %s, %r" % (case, " ".join(args[:2]), hostile), args, folder, [hostile],
                    program_apart=args[0] == "part.nc", files=[os.path.join(folder, "own.toml")])
    name = "names in dialect tables"
    fanuc = read(os.path.join(REPOSITORY, "grammars", "fanuc.toml")).decode()
    for hostile in chosen(judge):
        for case, new in (("first strings", re.sub(r'= "[^"\\]*"', lambda m: "= " + toml(hostile), fanuc, count=2)),
                          ("all strings but the first", None), ("unknown key", toml(hostile) + " = 1\n" + fanuc)):
            if new is None:
                head, tail = fanuc[:len(fanuc) // 3], fanuc[len(fanuc) // 3:]
                new = head + re.sub(r'= "([^"\\]{25,})"', lambda m: "= " + toml(m.group(1) + hostile), tail)
            write(os.path.join(folder, "own-dialect.toml"), new)
            for args in (["grammar", "check", "own-dialect.toml"], ["bad.nc", "-m", "mill.toml", "-d", "./own-dialect.toml"]):
                ask(judge, name, "%s, %s, %r" % (case, args[0], hostile), args, folder, [hostile], program_apart=args[0] != "grammar",
                    files=[os.path.join(folder, "own-dialect.toml")])
    name = "run ids and columns of measurements"
    rows = read(os.path.join(SAMPLES, "diagnosis", "backlash.csv")).decode()
    shutil.copy(os.path.join(SAMPLES, "diagnosis", "backlash.toml"), os.path.join(folder, "backlash.toml"))
    volume = read(os.path.join(SAMPLES, "calibration", "volume_points.csv")).decode()
    balls = read(os.path.join(SAMPLES, "calibration", "ballbar_circles.csv")).decode()

    def with_runs(table, hostile):
        lines = table.split("\n")
        head = next(i for i, line in enumerate(lines) if line and not line.startswith("#"))
        column = lines[head].split(",").index("run")
        return "\n".join(lines[:head + 1] + [",".join(hostile + c if i == column else c for i, c in enumerate(line.split(","))) if "," in line else line
                                             for line in lines[head + 1:]])
    for hostile in chosen(judge):
        write(os.path.join(folder, "rows.csv"), with_runs(rows, hostile))
        write(os.path.join(folder, "volume.csv"), with_runs(volume, hostile))
        write(os.path.join(folder, "balls.csv"), with_runs(balls, hostile))
        write(os.path.join(folder, "column.csv"), rows.replace("run,", "run," + hostile + ",", 1))
        write(os.path.join(folder, "cell.csv"), rows + ",".join([hostile] * rows.strip().split("\n")[-1].count(",")) + "," + hostile + "\n")
        write(os.path.join(folder, "mean.csv"), with_runs(rows, hostile).replace("0.", "900.", 3))
        new = ["--name", "N", "--chain", "[w X Y b Z t]"]
        for args in (["diagnose", "rows.csv", "-m", "backlash.toml"], ["diagnose", "rows.csv", "-m", "backlash.toml", "-v"],
                     ["diagnose", "column.csv", "-m", "backlash.toml"], ["diagnose", "cell.csv", "-m", "backlash.toml"], ["diagnose", "mean.csv", "-m", "backlash.toml"],
                     ["calibrate", "volumetric", "volume.csv"] + new, ["calibrate", "ballbar", "balls.csv", "-m", "mill.toml", "-o", "b.toml"],
                     ["calibrate", "volumetric", "rows.csv"] + new, ["calibrate", "interferometer", "column.csv"] + new, ["predict", "column.csv", "-m", "mill.toml"],
                     ["calibrate", "volumetric", "volume.csv", "--name", hostile, "--chain", "[w X Y b Z t]", "--date", hostile, "--instrument", hostile]):
            ask(judge, name, "%s, %r" % (" ".join(args[:3]), hostile), args, folder, [hostile], program_apart=False, files=[os.path.join(folder, args[1])])
    bytes_kept(judge, folder, text, reference, plain)


def bytes_kept(judge, folder, text, reference, plain):
    """NC on standard output is the program itself; and a machine's name brings nothing into it."""
    name = "the program itself keeps its bytes"
    for hostile in chosen(judge) + ["\x9b"]:
        odd = text.replace(b"M30", b"(" + (hostile.encode() if hostile != "\x9b" else b"\x9b\xcf") + b")\nM30")
        write(os.path.join(folder, "odd.nc"), odd)
        piped = judge.run(["odd.nc", "-m", "mill.toml"], cwd=folder)
        status, seen, _ = on_terminal(judge, ["odd.nc", "-m", "mill.toml"], folder)
        wanted = reference.replace(b"M30", odd[odd.index(b"Z50.\n(") + 5:odd.index(b"M30")] + b"M30") if piped.status == 0 else None
        if piped.status != 0:
            judge.judge(name, piped.out or piped.status not in (1, 2), "%r refused" % hostile, "exit status %d, %d bytes" % (piped.status, len(piped.out)), "nothing written", [])
        else:
            judge.judge(name, piped.out != wanted, "%r, into a pipe" % hostile, "changed", "bytes kept", ["odd.nc", "-m", "mill.toml"])
            judge.judge(name + " on a terminal, too", seen != piped.out, "%r" % hostile, "other bytes than into a pipe", "bytes kept",
                        ["odd.nc", "-m", "mill.toml"], [("terminal", seen), ("piped", piped.out)])
    name = "a machine's name brings nothing into the program"
    for machine in chosen(judge) + ["A)\nG0 Z-100 (", "A) G0 Z-100 (", "A\nM3 S9000", "A\rG0 Z0", "A;B", "A\u2028G0 Z0", "%", "A)", "(A", "\u0429 \u00e9", "a" * 3000, "A\tB"]:
        write(os.path.join(folder, "own.toml"), plain.replace('"Judge\'s mill"', toml(machine)))
        ended = judge.run(["part.nc", "-m", "own.toml"], cwd=folder)
        lines = ended.out.split(b"\n")
        others = [line for line in lines if b"CORRECTED BY VPOST" not in line]
        marks = [line for line in lines if b"CORRECTED BY VPOST" in line]
        wanted = [line for line in reference.split(b"\n") if b"CORRECTED BY VPOST" not in line]
        fine = ended.status in (1, 2) and not ended.out
        if ended.status == 0:
            mark = marks[0] if len(marks) == 1 else b"\0"
            fine = others == wanted and re.fullmatch(rb"\([\x20-\x27\x2a-\x7e]*\)", mark)
        judge.judge(name, not fine, "%r" % machine[:40], "exit status %d, %s %s" % (ended.status, first_line(ended.err), first_line(marks[0]) if marks else ""),
                    "refused, or one comment of plain characters", ["part.nc", "-m", "own.toml"], [os.path.join(folder, "own.toml"), ("out.nc", ended.out)])
