"""What judges have in common: the command line, the command that is judged, kept folders, figures at the end."""

import argparse
import collections
import multiprocessing
import pathlib
import re
import subprocess
import tempfile

import numpy as np


def run(vpost, *words):
    done = subprocess.run([str(vpost), *map(str, words)], capture_output=True, text=True, timeout=180)
    return done.returncode, done.stdout, done.stderr


def arguments(description):
    words = argparse.ArgumentParser(description=description)
    words.add_argument("--vpost", default="target/release/vpost")
    words.add_argument("--count", type=int, default=300)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--first", type=int, default=0)
    words.add_argument("--jobs", type=int, default=2)
    words.add_argument("--keep", help="folder for what is found")
    words.add_argument("--self-test", action="store_true")
    return words


def short(errors):
    return " | ".join(errors.strip().splitlines()[:4])[:300]


def microns(errors, code):
    """The largest number of micrometres in the first line of a message of that code, in mm: 0 if it says none, None without such a message."""
    texts = re.findall(r"\[%s\](.*)" % code, errors)
    return max([float(x) * 1e-3 for t in texts for x in re.findall(r"([\d.]+) ?[µu]m", t)], default=0.0) if texts else None


def corrected(options, folder, words):
    """(output, errors) or (None, (result, text)) where there is none."""
    status, output, errors = run(options.vpost, "correct", folder / "in.nc", *words)
    if status:
        code = (re.search(r"error\[(VP\d+)\]", errors) or [None, "without a code"])[1]
        return None, ("profile" if status == 2 else "refused by %s" % code, short(errors))
    (folder / "out.nc").write_text(output)
    return output, errors


def in_folder(options, n, judged):
    """judged(folder) in a folder of its own, which is kept where something is found."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        try:
            found = judged(folder)
        except subprocess.TimeoutExpired:
            found = "slow", "180 s", 0.0
        if options.keep and not found[0].startswith(("right", "refused", "unjudged")):
            keep = pathlib.Path(options.keep) / ("%d-%d-%s" % (options.seed, n, found[0]))
            keep.mkdir(parents=True, exist_ok=True)
            for f in folder.iterdir():
                (keep / f.name).write_bytes(f.read_bytes())
            (keep / "found.txt").write_text("%s\n%s\n" % found[:2])
        return found


def everything(options, one):
    """Runs one((options, n)) -> (n, result, text, {figure: um}, kinds) for all numbers. Exit status 1 where something is found."""
    tally, kinds, figures, first, found = collections.Counter(), collections.Counter(), {}, {}, 0
    with multiprocessing.Pool(options.jobs) as pool:
        for n, result, text, values, what in pool.imap(one, [(options, n) for n in range(options.first, options.first + options.count)]):
            tally[result] += 1
            first.setdefault(result, "as number %d: %s" % (n, text) if text else "")
            if result.startswith(("refused", "unjudged")):
                continue
            kinds.update(["%s, %s" % (w, "right" if result == "right" else "wrong") for w in what])
            for name, value in values.items():
                figures.setdefault(name, []).append(value)
            if result != "right":
                found += 1
                print("%-12s %4d  %s" % (result, n, text), flush=True)
    for name, count in sorted(kinds.items()) + sorted(tally.items()):
        print("%6d  %s  %s" % (count, name, first.get(name, "") if name.startswith(("refused", "unjudged")) else ""))
    for name, values in figures.items():
        print("%s, um: median %.2f, max %.2f" % (name, np.median(values), max(values)))
    return 1 if found else 0
