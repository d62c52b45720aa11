#!/usr/bin/python3
"""A command that makes every mistake this judge looks for; the self-test gives it to the checks. It corrects nothing: it adds a comment.

With CAREFUL in its own name it writes durably and stays whole, for the checks that must find nothing wrong.
"""

import json
import os
import re
import shutil
import signal
import sys
import time

NAME = os.path.basename(sys.argv[0])
CAREFUL = "careful" in NAME


def say(*text):
    sys.stderr.buffer.write(" ".join(text).encode("utf-8", "surrogateescape") + b"\n")
    sys.stderr.flush()


def load(path):
    if path == "-":
        return sys.stdin.buffer.read()
    data = b""
    with open(path, "rb") as src:
        before = os.fstat(src.fileno())
        while True:
            piece = src.read(20000)
            if not piece:
                break
            data += piece
            if not CAREFUL:
                time.sleep(0.002)
        after = os.stat(path)
    if CAREFUL and (before.st_size, before.st_mtime_ns, before.st_ino) != (after.st_size, after.st_mtime_ns, after.st_ino):
        say("the program changed")
        sys.exit(1)
    return data


def store(path, data):
    if not CAREFUL:
        with open(path + ".half", "wb") as out:
            out.write(data)
        os.replace(path + ".half", path)
        return
    path = os.path.realpath(path)
    beside = path + ".beside"
    with open(beside, "wb") as out:
        out.write(data)
        out.flush()
        os.fsync(out.fileno())
    if os.path.exists(path):
        shutil.copymode(path, beside)
    os.replace(beside, path)
    folder = os.open(os.path.dirname(path), os.O_RDONLY)
    os.fsync(folder)
    os.close(folder)


def option(args, *names):
    for index, word in enumerate(args):
        if word in names:
            return args[index + 1]
    return None


def corrected(data, mill):
    name = ""
    if mill and os.path.isfile(mill):
        found = re.search(r'name\s*=\s*("[^"]*")', open(mill, encoding="utf-8", errors="replace").read())
        name = json.loads(found.group(1), strict=False) if found else ""
    shift = b"(CORRECTED BY VPOST FOR %s)\n" % name.encode("utf-8", "replace")
    return data.replace(b"G17", shift + b"G17", 1)


def batch(args):
    out, mill = option(args, "-O"), option(args, "-m")
    os.makedirs(os.path.join(out, ".vpost", "journal"), exist_ok=True)
    programs = []
    for given in args[1:2]:
        for root, _, files in os.walk(given) if os.path.isdir(given) else [(os.path.dirname(given), [], [os.path.basename(given)])]:
            programs += [os.path.relpath(os.path.join(root, f), given if os.path.isdir(given) else os.path.dirname(given) or ".") for f in files]
        base = given if os.path.isdir(given) else os.path.dirname(given) or "."
    rows = []
    for name in sorted(programs):
        place = os.path.join(out, name)
        if not CAREFUL and os.path.exists(place) and not os.path.getsize(place):
            say(place, "is there")
            sys.exit(1)
        os.makedirs(os.path.dirname(place), exist_ok=True)
        data = corrected(load(os.path.join(base, name)), mill)
        store(place, data)
        rows.append(json.dumps({"output": name, "bytes": len(data)}))
        say("done", name)
    store(os.path.join(out, ".vpost", "journal", "batch.jsonl"), "\n".join(rows).encode())
    results = option(args, "--results")
    if results and results != "-":
        store(results, "\n".join(rows).encode())


def main():
    args = [a for w in sys.argv[1:] for a in (w.split("=", 1) if w.startswith("--") and "=" in w else [w])]
    if args[:2] == ["batch", "plan"]:
        rows = "".join(json.dumps({"output": "a.nc", "input": "in/a.nc", "bytes": 1}, separators=(",", ":")) + "\n" for _ in range(3))
        store(option(args, "--manifest"), (json.dumps({"programs": 3, "programs_blake3": ""}) + "\n" + rows).encode())
        return
    if args[:2] == ["batch", "run"]:
        rows = open(option(args, "--manifest"), "rb").read().decode().split("\n")[1:]
        for row in rows:
            try:
                os.makedirs("outs/.vpost", exist_ok=True)
                store(os.path.join("outs", json.loads(row)["output"]), b"M30\n")
            except (ValueError, OSError, KeyError, TypeError):
                pass
        return
    if args[:1] == ["batch"]:
        batch(args)
        return
    mill = option(args, "-m")
    say(" ".join(args))
    for path in [a for a in args if a.endswith((".nc", ".toml", ".csv", ".ngc")) and os.path.isfile(a)]:
        text = open(path, "rb").read()
        if b"Q0.0000001" in text or "--crossing" in args:
            while True:
                time.sleep(1)
        sys.stderr.buffer.write(text[:3000] + text[-3000:])
        if len(text) > 200000 and args[0] != "-" and not text.startswith(b"%"):
            end = time.process_time() + 3 * (len(text) / 1e6) ** 2
            while time.process_time() < end:
                pass
    if args and (args[0].endswith(".nc") or args[0] == "-"):
        data = corrected(load(args[0]), mill)
        out = option(args, "-o")
        if out:
            store(out, data)
        else:
            try:
                sys.stdout.buffer.write(data)
                sys.stdout.flush()
            except OSError:
                os._exit(0)
        if option(args, "--summary"):
            store(option(args, "--summary"), json.dumps({"input": {"bytes": len(data)}}).encode())
    else:
        for index, word in enumerate(args):
            if word in ("--json", "--html", "--csv", "--vtk", "-o", "--write-profile") and index + 1 < len(args):
                store(args[index + 1], b"written\n")


if not CAREFUL:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
main()
