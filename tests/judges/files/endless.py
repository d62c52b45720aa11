"""Work without end, and being asked to stop.

Programs that would become too much (tiny pecks, repeats, arcs of many turns, loops, calls) are refused within seconds in less than a
gigabyte, or answered so. And wherever the command is when SIGINT or SIGTERM comes - opening a FIFO that nobody writes, waiting in a pipe,
writing into a pipe that nobody empties, in the middle of long work - it ends within a second with 130 or 143 (or by that signal, which a
shell tells as the same), with the old output where one was and nothing in the temporary folder.
"""

import os
import random
import shutil
import signal
import subprocess
import time

from runner import REPOSITORY, broke_down, first_line, profile, program, read, tree, write

SECONDS, MEGABYTES = 10, 1000       # of processor time, for the computer may be busy; three times that by the clock
HEAD = "%\nO1\nG17 G21 G40 G49 G80 G90 G54\nG0 X10. Y10.\nG43 H1 Z50.\nG1 Z40. F500\n"
TAIL = "G80\nG0 Z50.\nM30\n%\n"
SIEMENS = "G17 G71 G90\nG0 X10 Y10 Z60\nG1 Z50 F200\n"
PLAIN = "G17 G21 G40 G49 G80 G90 G54\nG0 X10. Y10.\nG43 H1 Z50.\nG1 Z40. F500\n"
BOMBS = (
    ("fanuc", "G83 X10. Y10. Z1. R30. Q0.0000001 F100"), ("fanuc", "G83 X10. Y10. Z1. R30. Q0.001 F100"), ("fanuc", "G73 X10. Y10. Z1. R30. Q0.0000001 F100"),
    ("fanuc", "G83 X10. Y10. Z1. R30. Q0 F100"), ("fanuc", "G83 X10. Y10. Z1. R30. Q-0.0000001 F100"), ("fanuc", "G83 X10. Y10. Z1. R30. Q1e-9 F100"),
    ("fanuc", "G83 X10. Y10. Z1. R30. Q0.00000000000000000000000000000000001 F100"),
    ("fanuc", "G91 G81 X0.001 Y0. Z-5. R-2. K999999999 F100"), ("fanuc", "G91 G81 X0.0000001 Z-5. R-2. L2000000000 F100"), ("fanuc", "G81 X10. Y10. Z5. R10. K999999999999999999999 F100"),
    ("fanuc", "G91 G83 X0.001 Z-20. R-2. Q0.0001 K9999 F100"), ("fanuc", "G81 X10. Y10. Z5. R10. F100\n" + "X11. K9999\n" * 3000),
    ("fanuc", "M98 P9999999999"), ("fanuc", "M98 P2 L999999999\nM30\nO2\nG1 X20.\nX10.\nM99"), ("fanuc", "M98 P2 L9999\nM30\nO2\nM98 P3 L9999\nM99\nO3\nM98 P4 L9999\nM99\nO4\nG1 X20.\nM99"),
    ("fanuc", "M98 P2\nM30\nO2\nM98 P2\nM99"), ("fanuc", "WHILE [1 EQ 1] DO1\nG1 X20.\nEND1"), ("fanuc", "WHILE [1 EQ 1] DO1\nEND1"), ("fanuc", "#1=0\nWHILE [#1 LT 1] DO1\n#1=#1+0.0000001\nG1 X[10+#1]\nEND1"),
    ("fanuc", "#1=0\nWHILE [#1 LT 1000000000000] DO1\n#1=#1+1\nEND1"), ("fanuc", "N5 GOTO 5"), ("fanuc", "N5 G1 X11.\nX10.\nGOTO 5"), ("fanuc", "G1 X20.\nM99"),
    ("fanuc", "G65 P2 L999999999\nM30\nO2\nG1 X20.\nM99"), ("fanuc", "G66 P2 L999999\nX11.\nX12.\nM30\nO2\nG1 Z20.\nM99"),
    ("fanuc", "G2 X10. Y10. I0.0000001 J0. F100"), ("fanuc", "G2 X10. Y10. I0.001 J0. Z0. F100"), ("fanuc", "G2 X10.0000001 Y10. I5. J0. F100"), ("fanuc", "G1 X10.000000000000000000001"),
    ("fanuc", "G1 X" + "9" * 300 + "."), ("fanuc", "G1 X" + "9" * 1000000 + "."), ("fanuc", "G1 X0." + "0" * 1000000 + "1"), ("fanuc", "G4 P99999999999999999999\nG1 X11."),
    ("fanuc", "G93\nG1 X20. F0.0000000001"), ("fanuc", "G1 X20. F1" + "0" * 30), ("fanuc", "G1 X[" + "[" * 100000 + "1" + "]" * 100000 + "]"), ("fanuc", "G1 X20. (" + "(" * 100000),
    ("linuxcnc", "G2 X10. Y10. I1. J0. P1000000000 F100"), ("linuxcnc", "G2 X10. Y10. I1. J0. Z30. P100000000 F100"), ("linuxcnc", "G2 X10. Y10. I1. J0. Z30. P18446744073709551615 F100"),
    ("linuxcnc", "G83 X10. Y10. Z1. R30. Q0.0000001 F100"), ("linuxcnc", "G83 X10. Y10. Z1. R30. Q1e-7 F100"), ("linuxcnc", "G73 X10. Y10. Z1. R30. Q0.0000001 F100"),
    ("linuxcnc", "G91 G81 X0.001 Z-5. R-2. L1000000000 F100"), ("linuxcnc", "o1 repeat [1000000000]\nG1 X11.\nX10.\no1 endrepeat"), ("linuxcnc", "o1 repeat [1000000000000]\no1 endrepeat"),
    ("linuxcnc", "o1 while [1]\nG1 X11.\nX10.\no1 endwhile"), ("linuxcnc", "o1 do\no1 while [1]"), ("linuxcnc", "o1 while [1]\no1 endwhile"),
    ("linuxcnc", "o<a> sub\no<a> call\no<a> call\no<a> endsub\no<a> call"), ("linuxcnc", "G76 P0.0000001 Z1. I-1. J0.0000001 K0.5 F100"), ("linuxcnc", "G5.2 X20. Y20. L3 P1\nX30. Y10. P1\nG5.3"),
    ("linuxcnc", "#1=0\no1 while [#1 LT 1]\n#1=[#1+0.0000001]\nG1 X[10+#1]\no1 endwhile"),
    ("sinumerik", "G2 X10 Y10 I1 J0 TURN=999999999 F100"), ("sinumerik", "G2 X10 Y10 I1 J0 Z30 TURN=999999999999999999999 F100"), ("sinumerik", "A:\nG1 X11\nX10\nB:\nREPEAT A B P=999999999"), ("sinumerik", "FOR R1=1 TO 1000000000000\nENDFOR"),
    ("sinumerik", "LOOP\nG1 X11\nX10\nENDLOOP"), ("sinumerik", "WHILE TRUE\nENDWHILE"), ("sinumerik", "A:\nGOTOB A"), ("sinumerik", "CYCLE83(50,10,2,1,,,,0.0000001,0.0000001,0,0,1,1)"),
    ("centroid", "G83 X10 Y10 Z1 R30 Q0.0000001 F100"), ("centroid", "G81 X10 Y10 Z1 R30 L999999999 F100"), ("perspektiva", "G83 X10 Y10 Z1 R30 Q0.0000001 F100"), ("balt-system", "(RPT,999999999)\nG1 X11\n(ERP)"),
)


def lean(folder):
    """A machine whose Z leans and has play, so that holes have to be written as moves."""
    plain = read(os.path.join(folder, "mill.toml")).decode()
    write(os.path.join(folder, "lean.toml"), plain.replace("EA0Z_urad = 55.0", "EA0Z_urad = 2055.0").replace("[axis.Z]\n", "[axis.Z]\nbacklash_um = 5.0\n"))


def bombs(judge, folder):
    name = "work without end refused soon"
    plain = read(os.path.join(folder, "mill.toml")).decode()
    lean(folder)
    write(os.path.join(folder, "tight.toml"), plain.replace("tolerance_um = 1.0", "tolerance_um = 0.000001"))
    write(os.path.join(folder, "long.toml"), plain.replace("[0, 400]", "[-1e12, 1e12]").replace('errors        = "x.csv"', "").replace("measured_at_mm", "# measured_at_mm"))
    write(os.path.join(folder, "wavy.csv"), "position_mm,EXX_um\n" + "".join("%.2f,%d\n" % (i * 0.01, 40 * (i % 2)) for i in range(40001)))
    write(os.path.join(folder, "wavy.toml"), plain.replace('"x.csv"', '"wavy.csv"'))
    for number, (dialect, text) in enumerate(BOMBS if judge.count >= 20 else BOMBS[:1] + BOMBS[1::10]):
        head = HEAD if dialect == "fanuc" else SIEMENS if dialect in ("sinumerik", "balt-system") else PLAIN
        path = write(os.path.join(folder, "bomb%d.nc" % number), head + text + "\n" + (TAIL if dialect == "fanuc" else "M30\n"))
        part = os.path.basename(path)
        for args in ([part, "-m", "mill.toml", "-d", dialect, "-o", "out.nc"], [part, "-m", "lean.toml", "-d", dialect, "-o", "out.nc"],
                     ["check", part, part, "-m", "lean.toml", "-d", dialect]):
            ask(judge, name, "%s: %s (%s)" % (dialect, text[:60].replace("\n", " / "), "check" if args[0] == "check" else args[2]), args, folder,
                [path, os.path.join(folder, "lean.toml")])
    for mill in ("tight.toml", "long.toml", "wavy.toml"):
        for text in ("G1 X300. F100", "G2 X10. Y10. I50. J0. F100", "G2 X10. Y10. I100000. J0. F100", "G1 X999999999. F100", "G0 X999999999.\nG1 X-999999999. F100"):
            path = write(os.path.join(folder, "long.nc"), HEAD + text + "\n" + TAIL)
            for more in ([], ["--outside", "clamp"]):
                ask(judge, name, "%s: %s %s" % (mill, text.replace("\n", " / "), " ".join(more)), ["long.nc", "-m", mill, "-o", "out.nc"] + more, folder, [path, os.path.join(folder, mill)])
    line = "G1 X" + "1" * 100 + " "
    for case, data in (("a line of 200 MB", HEAD.encode() + line.encode() * 2000000), ("NUL bytes, 200 MB", b"\0" * 200_000_000), ("20 million empty lines", b"\n" * 20_000_000)):
        ask(judge, name, case, ["-", "-m", "mill.toml", "-o", "out.nc"], folder, [], data)


def ask(judge, name, case, args, folder, files, data=None):
    if os.path.exists(os.path.join(folder, "out.nc")):
        os.remove(os.path.join(folder, "out.nc"))
    ended = judge.run(args, cwd=folder, timeout=3 * SECONDS, data=data)
    left = os.listdir(judge.tmp)
    out = os.path.exists(os.path.join(folder, "out.nc"))
    wrong = ended.timed_out or ended.cpu > SECONDS or ended.peak_mb > MEGABYTES or broke_down(ended) or ended.status not in (0, 1, 2) or left or (ended.status != 0 and out)
    judge.judge(name, wrong, case, "exit status %d%s, %.1f s, %.0f MB%s; %s" % (ended.status, " (killed: too long)" if ended.timed_out else "", ended.seconds, ended.peak_mb,
                ", left in TMPDIR: %s" % left if left else "", first_line(ended.err)), "refused, or answered, in %d s and %d MB" % (SECONDS, MEGABYTES), args, files)
    for path in left:
        os.remove(os.path.join(judge.tmp, path))


def interrupts(judge, folder):
    text = read(os.path.join(folder, "part.nc"))
    big = program(random.Random(5), 300000)
    write(os.path.join(folder, "big.nc"), big)
    wavy = "wavy.toml"
    if not os.path.exists(os.path.join(folder, wavy)):
        shutil.copy(os.path.join(folder, "mill.toml"), os.path.join(folder, wavy))
    for index in range(6):
        write(os.path.join(folder, "many", "p%d.nc" % index), big)
    os.makedirs(os.path.join(folder, "subs"), exist_ok=True)
    for fifo in ("fifo.nc", "fifo.toml", "fifo.csv", "subs/O2000", "fifo.jsonl"):
        if not os.path.exists(os.path.join(folder, fifo)):
            os.mkfifo(os.path.join(folder, fifo))
    write(os.path.join(folder, "caller.nc"), text.replace(b"G0 Z50.\nM30", b"M98 P2000\nG0 Z50.\nM30"))
    plain = read(os.path.join(folder, "mill.toml")).decode()
    write(os.path.join(folder, "on-fifo.toml"), plain.replace('"x.csv"', '"fifo.csv"'))
    write(os.path.join(folder, "peck.nc"), HEAD + "G83 X10. Y10. Z1. R30. Q0.0001 F100\n" + TAIL)
    lean(folder)
    write(os.path.join(folder, "loop.nc"), HEAD + "#1=0\nWHILE [#1 LT 1000000000000] DO1\n#1=#1+1\nEND1\n" + TAIL)
    for name in ("rows.csv", "backlash.toml"):
        shutil.copy(os.path.join(REPOSITORY, "samples", "diagnosis", name.replace("rows", "backlash")), os.path.join(folder, name))
    head, *rows = [r for r in read(os.path.join(folder, "rows.csv")).decode().split("\n") if r and not r.startswith("#")]
    write(os.path.join(folder, "rows.csv"), "\n".join([head] + rows * (60000 // len(rows) + 1)) + "\n")
    out = ["-o", "out.nc"]
    fifo_cases = (("opening a FIFO as the program", ["fifo.nc", "-m", "mill.toml"] + out, "open"), ("reading a FIFO as the program", ["fifo.nc", "-m", "mill.toml"] + out, "half:fifo.nc"),
                  ("opening a FIFO as the profile", ["part.nc", "-m", "fifo.toml"] + out, "open"), ("opening a FIFO as a table", ["part.nc", "-m", "on-fifo.toml"] + out, "open"),
                  ("opening a FIFO as a subprogram", ["caller.nc", "-m", "mill.toml", "--include", "subs"] + out, "open"), ("check, opening a FIFO", ["check", "fifo.nc", "part.nc", "-m", "mill.toml"], "open"),
                  ("predict, opening a FIFO", ["predict", "fifo.csv", "-m", "mill.toml"], "open"), ("diagnose, opening a FIFO", ["diagnose", "fifo.csv", "-m", "backlash.toml"], "open"),
                  ("batch, opening a FIFO", ["batch", "fifo.nc", "-m", "mill.toml", "-O", "outs"], "open"), ("batch run, opening a FIFO", ["batch", "run", "--manifest", "fifo.jsonl"], "open"))
    pipe_cases = (("a pipe that says nothing", ["-", "-m", "mill.toml"] + out, b""), ("a pipe in the middle", ["-", "-m", "mill.toml"] + out, big[:4_000_000]),
                  ("a pipe in the middle of a line", ["-", "-m", "mill.toml"], text[:200]), ("predict from a pipe", ["predict", "-", "-m", "mill.toml"], b"x_mm,y_mm,z_mm\n"))
    full_cases = (("a full pipe behind the program", ["big.nc", "-m", "mill.toml"]), ("a full pipe behind predict", ["predict", "many.csv", "-m", "mill.toml"]),
                  ("a full pipe behind a file that is held back", ["big.nc", "-m", "mill.toml", "--summary", "sum.json"]))
    write(os.path.join(folder, "many.csv"), "x_mm,y_mm,z_mm\n" + "10,10,10\n" * 200000)
    work_cases = (("a large program", ["big.nc", "-m", "mill.toml"] + out), ("a program that is split much", ["big.nc", "-m", wavy] + out), ("check of large programs", ["check", "big.nc", "big.nc", "-m", "mill.toml"]),
                  ("pecks", ["peck.nc", "-m", "lean.toml"] + out), ("a loop", ["loop.nc", "-m", "mill.toml"] + out), ("a map", ["map", "-m", "mill.toml", "--grid", "200x200x200"]),
                  ("a budget", ["budget", "-m", "mill.toml", "--grid", "60x60x60"]), ("a budget with tolerances", ["budget", "-m", "mill.toml", "--grid", "40x40x40", "--target", "5"]), ("a diagnosis", ["diagnose", "rows.csv", "-m", "backlash.toml"]),
                  ("a batch", ["batch", "many", "-m", "mill.toml", "-O", "outs"]), ("a batch on one core", ["batch", "many", "-m", "mill.toml", "-O", "outs", "-j", "1"]))
    for number, shell in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
        for case, args, how in fifo_cases:
            interrupted(judge, folder, case, args, number, shell, wait=0.25, feed=how)
        for case, args, data in pipe_cases:
            interrupted(judge, folder, case, args, number, shell, wait=0.4, data=data)
        for case, args in full_cases:
            interrupted(judge, folder, case, args, number, shell, wait=4.0, full=True)
        for case, args in work_cases:
            for wait in (0.05, 0.3, 0.8):
                interrupted(judge, folder, case, args, number, shell, wait=wait)


def interrupted(judge, folder, case, args, number, shell, wait, feed=None, data=None, full=False, tries=3):
    name = "SIGINT and SIGTERM act within a second"
    old = b"(AN OLD OUTPUT)\n"
    write(os.path.join(folder, "out.nc"), old)
    shutil.rmtree(os.path.join(folder, "outs"), ignore_errors=True)
    child = judge.start(args, cwd=folder, stdin=subprocess.PIPE if data is not None else None, stdout=subprocess.PIPE if full else None)
    writer = None
    try:
        if data:
            child.stdin.write(data)
            child.stdin.flush()
        if feed and feed.startswith("half:"):
            for _ in range(200):
                try:
                    writer = os.open(os.path.join(folder, feed[5:]), os.O_WRONLY | os.O_NONBLOCK)
                    os.write(writer, b"%\nO1\nG0 X1.\n")
                    break
                except OSError:
                    time.sleep(0.01)
        time.sleep(wait)
        if child.poll() is not None:
            if (feed or data is not None or full) and "subprogram" not in case:
                judge.fail(name, "%s, %s" % (case, signal.Signals(number).name), "ended by itself with exit status %d" % child.returncode, "waits until it is asked to stop", args)
            return
        begin = time.monotonic()
        os.kill(child.pid, number)
        try:
            child.wait(timeout=6)
        except subprocess.TimeoutExpired:
            pass
        seconds = time.monotonic() - begin
        acted = child.poll() is not None
    finally:
        if child.poll() is None:
            child.kill()
            child.wait()
        for pipe in (child.stdin, child.stdout):
            if pipe:
                try:
                    pipe.close()
                except BrokenPipeError:
                    pass
        if writer is not None:
            os.close(writer)
    left = sorted(os.listdir(judge.tmp)) + [n for n in tree(os.path.join(folder, "outs")) if n.startswith(".vpost/tmp") or not n.startswith(".vpost/")
                                            and b"M30" not in (read(os.path.join(folder, "outs", n)) or b"")]
    same = read(os.path.join(folder, "out.nc")) == old
    right_end = child.returncode in (shell, -number) or (child.returncode in (0, 1) and seconds < 1 and not full and feed is None and data is None)
    # Work that ends by itself within that second, done or refused, has ended in time.
    if acted and seconds > 1 and tries > 1:         # the computer may be busy: only what is late three times is late
        interrupted(judge, folder, case, args, number, shell, wait, feed, data, full, tries - 1)
        return
    judge.judge(name, not acted or seconds > 1 or not right_end or (not same and child.returncode != 0) or left, "%s, %s after %.2f s" % (case, signal.Signals(number).name, wait),
                "%s after %.2f s, exit status %d, output %s%s" % ("ended" if acted else "went on", seconds, child.returncode, "as before" if same else "changed", ", left: %s" % left[:3] if left else ""),
                "ends within a second with %d, nothing half done" % shell, args)
    for path in os.listdir(judge.tmp):
        os.remove(os.path.join(judge.tmp, path))


def run(judge):
    folder = judge.folder("endless")
    profile(folder)
    write(os.path.join(folder, "part.nc"), program(random.Random(2), 200))
    bombs(judge, folder)
    interrupts(judge, folder)
