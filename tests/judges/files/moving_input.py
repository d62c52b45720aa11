"""Input that changes while it is read: refused, or the whole output of one version; never a mixture, never a program cut off.

Two kinds of writer. One never rests: it appends from before the command starts until after its end, so that whatever was read was not
the program. The other acts once, at a random moment of the run, while the command is held by
SIGSTOP or while strace holds up its reads: it rewrites the file in place with
the same size, empties and writes it again, cuts it, appends to it, or puts another file under its name. In every version every block is
marked, so that a mixture of two is no correction of either. Kernels before 6.13 keep the time of a file to some milliseconds; the writer
waits that long before it acts, so that the time differs.
"""

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time

from runner import broke_down, profile, program, read, stop, write

GROW = """
import os, sys, time
path, data = sys.argv[1], open(sys.argv[2], "rb").read()
at, step = int(sys.argv[3]), 400
out = os.open(path, os.O_WRONLY | os.O_APPEND)
print("on", flush=True)
while True:
    at += os.write(out, data[at:at + step] or b"(MORE)\\n")
    time.sleep(0.0001)
"""


def other_version(text):
    """The same blocks with other places: the same size, every block different."""
    return text.replace(b" X00", b" X01").replace(b"(A)", b"(B)")


def act(kind, path, one, two):
    """Changes the file; returns what it holds then."""
    time.sleep(0.012)
    if kind == "same size":
        with open(path, "r+b") as out:
            out.write(two)
    elif kind == "emptied and written":
        with open(path, "wb") as out:
            out.write(two)
    elif kind == "appended":
        with open(path, "ab") as out:
            out.write(two[len(two) // 2:])
    elif kind == "cut":
        with open(path, "r+b") as out:
            out.truncate(one.index(b"\n", len(one) // 2) + 1)
    elif kind == "renamed over":
        write(path + ".new", two)
        os.rename(path + ".new", path)
    return read(path)


def identity(summary):
    try:
        return json.loads(summary)["input"]
    except (TypeError, ValueError, KeyError):
        return None


def run(judge):
    rng = random.Random(judge.seed + 1)
    folder = judge.folder("moving")
    mill = profile(folder)
    path = os.path.join(folder, "part.nc")
    out = os.path.join(folder, "out.nc")
    summary = os.path.join(folder, "summary.json")
    old = b"(AN OLD OUTPUT)\n"
    one = program(rng, 12000, " (A)")
    two = other_version(one)
    known = {}

    def corrected(data, arguments=()):
        """What an undisturbed run makes of these bytes: output and identity of the input, or None where it refuses them."""
        if data not in known:
            write(path, data)
            write(out, old)
            ended = judge.run([path, "-m", mill, "-o", out, "--summary", summary])
            known[data] = (read(out), identity(read(summary)), ended.seconds) if ended.status == 0 else (None, None, ended.seconds)
        return known[data]

    name = "input changed while it is read"
    first = corrected(one)
    if not judge.judge(name, first[0] is None or corrected(two)[0] in (None, first[0]), "undisturbed", "refused, or both versions give the same",
                       "two different outputs"):
        return
    # Once, at a random moment; in every other run while each read of the file is held up, so that the moment falls between two reads.
    slow = None
    if shutil.which("strace"):
        slow = ["strace", "-f", "-qq", "-o", "/dev/null", "-P", path, "-e", "trace=read,pread64,readv,preadv",
                "-e", "inject=read,pread64,readv,preadv:delay_exit=15000"]
        write(path, one)
        begin = time.monotonic()
        judge.start([path, "-m", mill, "-o", out], cwd=folder, under=slow).wait()
        slow_seconds = time.monotonic() - begin
    else:
        judge.note("reads cannot be held up: no strace")
    for number in range(max(20, 2 * judge.count)):
        kind = ["same size", "emptied and written", "appended", "cut", "renamed over"][number % 5]
        piped = number % 3 == 2
        held_up = slow is not None and number % 2 == 1
        write(path, one)
        write(out, old)
        time.sleep(0.012)
        args = [path, "-m", mill] + ([] if piped else ["-o", out, "--summary", summary])
        with open(out, "r+b") as direct:
            child = judge.start(args, cwd=folder, stdout=direct if piped else None, under=slow if held_up else ())
        if held_up:
            time.sleep(rng.uniform(0, slow_seconds))
            stopped = False
        else:
            time.sleep(rng.uniform(0, first[2] * 0.9) if rng.random() < 0.7 else rng.uniform(0, 0.02))
            stopped = stop(child)
        then = act(kind, path, one, two)
        if stopped:
            os.kill(child.pid, signal.SIGCONT)
        status = child.wait()
        got, said = read(out), identity(read(summary))
        good = [v for v in (corrected(one), corrected(then)) if v[0] is not None]
        case = "%s, %s%s" % (kind, "reads held up" if held_up else "stopped" if stopped else "after the end",
                             ", on standard output" if piped else "")
        if status == 0:
            wrong = got not in [v[0] for v in good]
            found = "exit status 0, %d bytes that are no output of one version" % len(got)
        else:
            wrong = got != old or status not in (1, 2)
            found = "exit status %d, output %s" % (status, "as before" if got == old else "changed: %d bytes" % len(got))
        judge.judge(name, wrong, case, found, "exit status not 0 and the old output, or the whole output of one version", args,
                    [path, out, mill, ("one.nc", one), ("then.nc", then)])
        if status == 0 and not wrong and not piped:
            judge.judge(name + ", summary", said != [v[1] for v in good if v[0] == got][0], case, "the summary names %s" % said,
                        "size and hash of the version that was corrected", args)
    # Without rest.
    text = program(rng, 120000, " (A)")
    begin = text.index(b"\n", len(text) // 2) + 1
    whole = write(os.path.join(folder, "whole"), text)
    for number in range(max(4, judge.count // 5)):
        write(path, text[:begin])
        write(out, old)
        writer = subprocess.Popen([sys.executable, "-c", GROW, path, whole, str(begin)], stdout=subprocess.PIPE)
        try:
            writer.stdout.readline()
            if number % 2:
                args = ["batch", path, "-m", mill, "-O", os.path.join(folder, "batch%d" % number)]
                target = os.path.join(folder, "batch%d" % number, "part.nc")
            else:
                args, target = [path, "-m", mill, "-o", out], out
            ended = judge.run(args, cwd=folder)
        finally:
            writer.kill()
            writer.wait()
            writer.stdout.close()
        got = read(target)
        judge.judge(name + " without rest", ended.status == 0 or got not in (None, old) or broke_down(ended), args[0] if number % 2 else "single",
                    "exit status %d, output %s" % (ended.status, "as before" if got in (None, old) else "of %d bytes" % len(got)),
                    "refused, no output", args, [mill])
    # A batch whose program changes in the middle: the same command ends it.
    for number in range(max(2, judge.count // 10)):
        for index in range(6):
            write(os.path.join(folder, "in", "p%d.nc" % index), one if index == 3 else program(rng, 500))
        part = os.path.join(folder, "in", "p3.nc")
        time.sleep(0.012)
        args = ["batch", "in", "-m", mill, "-O", "shop%d" % number, "-j", "1"]
        child = judge.start(args, cwd=folder)
        time.sleep(rng.uniform(0, first[2] * 1.2))
        if stop(child):
            act(rng.choice(["same size", "emptied and written"]), part, one, two)
            os.kill(child.pid, signal.SIGCONT)
        child.wait()
        got = read(os.path.join(folder, "shop%d" % number, "p3.nc"))
        fine = got in (None, corrected(one)[0], corrected(two)[0])
        ended = judge.run(args, cwd=folder)
        last = read(os.path.join(folder, "shop%d" % number, "p3.nc"))
        judge.judge(name + " in batch", not fine or ended.status != 0 or last != corrected(read(part))[0], "run %d" % number,
                    "%s; the second run: exit status %d, output %s" % ("one version" if fine else "a mixture", ended.status,
                    "right" if last == corrected(read(part))[0] else "wrong"), "one version; then the right output", args)
