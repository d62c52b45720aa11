#!/usr/bin/python3
"""Real milling programs from a folder (not part of the repository): each corrected and held, or refused by line.

    /usr/bin/python3 tests/judges/shops/unseen.py FOLDER --dialect haas --vpost target/release/vpost [--keep DIR] [--list]

Programs: what has one of --endings, below any folder. The machine is that of `tests/profiles/linuxcnc_samples.toml`, wide
and crooked, with lengths and radii H1 to H99, the dialect's work offsets and `tool_change = { keeps = "XYZ" }`. Where the
message asks for it, `--decimal millimetres` is given, and `--start-at` with --start. Each corrected one goes through
`vpost check` and, where LinuxCNC's interpreter reads both texts, before the second judge (`tests/referee`). Counted:
corrected, unchanged (no feed motion), refused (by number), WRONG (either judge says no, or `vpost` fails otherwise). Exit
status 1 where one is WRONG.
"""

import argparse
import collections
import json
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
PROFILES = os.path.join(ROOT, "tests", "profiles")
REFEREE = os.path.join(ROOT, "tests", "referee", "referee.py")
# Controls whose programs LinuxCNC's interpreter reads, where it reads all their codes: the referee takes M, S, T, H and D
# out itself.
SHARED = ("linuxcnc", "fanuc", "haas", "mach", "mitsubishi", "centroid")
START = "100,80,300"


def profile(dialect, folder, radii):
    with open(os.path.join(PROFILES, "linuxcnc_samples.toml"), encoding="utf-8") as file:
        text = file.read()
    text = re.sub(r'errors( *)= "(\w+\.csv)"', lambda m: f'errors{m.group(1)}= "{PROFILES}/{m.group(2)}"', text)
    text = text.replace('control = "linuxcnc"', f'control = "{dialect}"')
    lengths = "".join(f"H{k} = {40 + 2.5 * k}\n" for k in range(1, 100))
    text = re.sub(r"\[tool\.lengths_mm\]\n(H\d+ = .*\n)+", "[tool.lengths_mm]\n" + lengths, text)
    offsets = re.search(r"\[work_offsets_mm\]\n((.+\n)*)", text).group(1)
    if dialect not in ("linuxcnc",):
        offsets = "".join(line + "\n" for line in offsets.splitlines() if "G59." not in line)
    if dialect in ("fanuc", "haas", "mitsubishi", "mach"):
        offsets += "".join(f'"G54.1P{k}" = [{160 + k}, {50 - k}, {46 + k}]\n' for k in range(1, 49))
    if dialect == "okuma":
        offsets = "".join(f"G15H{k} = [{90 + 10 * k}, {85 - 5 * k}, {39 + k}]\n" for k in range(1, 21))
    if dialect.startswith("sinumerik"):
        offsets += "".join(f"G{k} = [{k - 400}, {560 - k}, {k - 460}]\n" for k in range(505, 520)) + "G500 = [0, 0, 0]\n"
    text = re.sub(r"\[work_offsets_mm\]\n((.+\n)*)", "[work_offsets_mm]\n" + offsets, text)
    program = "tool_change = { keeps = \"XYZ\" }\n"
    text = text.replace("[program]\n", "[program]\n" + program) if "[program]\n" in text else text + "\n[program]\n" + program
    if radii:
        text += "\n[tool.radii_mm]\n" + "".join(f"D{k} = {radii}\n" for k in range(1, 100))
    name = os.path.join(folder, "machine.toml")
    with open(name, "w", encoding="utf-8") as file:
        file.write(text)
    return name


def ran(command, seconds=300):
    try:
        done = subprocess.run(command, capture_output=True, timeout=seconds, check=False)
    except subprocess.TimeoutExpired:
        return None, "", f"no end within {seconds} s"
    return done.returncode, done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace")


def one(options, machine, path, work):
    """What became of a program: (word, message, largest before and after in um, second judge)."""
    out = os.path.join(work, "out.nc")
    ways = []
    while True:
        if os.path.exists(out):
            os.remove(out)
        command = [options.vpost, path, "-m", machine, "--zero", "true", "-d", options.dialect, "-q", "--color", "never", "--include", os.path.dirname(path), "-o", out]
        status, _, said = ran(command + ways)
        if status == 1 and "--decimal" in said and "--decimal" not in ways:
            ways += ["--decimal", "millimetres"]
        elif status == 1 and options.start and "--start-at" in said and "--start-at" not in ways:
            ways += ["--start-at", START]
        else:
            break
    if status == 1:
        number = re.search(r"error\[(VP\d+)\]: (.*)", said)
        return ("refused", number.group(1) if number else "no number", (number.group(2) if number else said)[:150], "")
    if status != 0:
        return ("WRONG", f"exit status {status}", said[-300:], "")
    status, text, said = ran([options.vpost, "check", path, out, "-m", machine, "--zero", "true", "-d", options.dialect, "--json", "--color", "never", "--include", os.path.dirname(path)] + ways)
    try:
        found = json.loads(text)
    except ValueError:
        found = {}
    if status != 0:
        return ("WRONG", "check", (said or text)[-300:], "")
    motions = found.get("motions", found.get("compared", {}).get("motions") if isinstance(found.get("compared"), dict) else None)
    second = "not asked"
    if options.dialect in SHARED and "--start-at" not in ways:
        second = judged(options, machine, path, out, ways, work)
        if second.startswith("WRONG"):
            return ("WRONG", "second judge", second, "")
    if motions == 0:
        return ("unchanged", "", "", second)
    return ("corrected", " ".join(ways), "", second)


def judged(options, machine, path, out, ways, work):
    texts = []
    for k, name in enumerate((path, out)):
        with open(name, "rb") as file:
            text = file.read()
        if options.dialect != "linuxcnc":
            # A program number, or N with five digits, is no word of LinuxCNC's; what it has no code for makes it refuse.
            text = re.sub(rb"(?mi)^\s*[O:]\d+", b"", text)
            text = re.sub(rb"(?i)\bN\d+\b", b"", text)
            text = re.sub(rb";", b"", text) if options.dialect != "mach" else text
        texts.append(os.path.join(work, f"shared{k}.ngc"))
        with open(texts[-1], "wb") as file:
            file.write(text)
    with open(path, "rb") as file:
        inch = re.search(rb"(?i)G(20|70)\b", file.read()) is not None
    command = ["/usr/bin/python3", REFEREE, "--in", texts[0], "--out", texts[1], "--model", machine, "--resolution", "2.54" if inch else "1"]
    if "--decimal" not in ways and options.dialect in ("fanuc", "haas", "mitsubishi"):
        command += ["--least-increment", "4" if inch else "3"]
    status, text, said = ran(command)
    if status == 0:
        return "holds"
    if status == 1:
        failures = json.loads(text)["failures"]
        way = [re.match(r"path: ([0-9.]+) um at line (\d+)", failure) for failure in failures]
        if all(way) and all(float(m.group(1)) < 1000 and begins(texts[0], int(m.group(2))) for m in way):
            return "begins with a way"
        return "WRONG " + "; ".join(failures)[:200]
    return "not read: " + (said or text).strip().splitlines()[-1][:120] if (said or text).strip() else "not read"


def begins(name, line):
    """The line is the first feed behind a tool change or a return.

    In front of it an axis was positioned before all three were known, so that its rapid stayed as it was
    (docs/decisions.md, "Rapids before all axes are known stay as they are"): the feed begins with its way, in the air.
    """
    feeds, first = False, True
    with open(name, "rb") as file:
        for k, text in enumerate(file.read().upper().splitlines(), 1):
            text = re.sub(rb"\(.*?\)", b"", text)
            if re.search(rb"M0?6(?!\d)|G28(?!\d)|G30(?!\d)|G53(?!\d)", text):
                feeds, first = False, True
                continue
            motion = re.findall(rb"G0?([0123])(?!\d)", text)
            feeds = motion[-1] != b"0" if motion else feeds
            if feeds and re.search(rb"[XYZ]", text):
                if k == line:
                    return first
                first = False
    return False


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("folder", nargs="+")
    words.add_argument("--dialect", required=True)
    words.add_argument("--vpost", default="target/release/vpost")
    words.add_argument("--endings", default="nc,ngc,gcode,gc,tap,cnc,mpf,spf,min,eia,ptp,txt")
    words.add_argument("--radii", type=float, help="radius of every D, mm; left out: the profile knows none")
    words.add_argument("--start", action="store_true", help=f"--start-at {START} where the message names it")
    words.add_argument("--list", action="store_true", help="a line a program")
    options = words.parse_args()
    options.vpost = os.path.abspath(options.vpost)
    endings = tuple("." + ending for ending in options.endings.split(","))
    paths = []
    for folder in options.folder:
        if os.path.isfile(folder):
            paths.append(os.path.abspath(folder))
        for where, _, names in sorted(os.walk(folder)):
            paths += [os.path.abspath(os.path.join(where, name)) for name in sorted(names) if name.lower().endswith(endings)]
    counted, seconds, wrong = collections.Counter(), collections.Counter(), 0
    causes = {}
    with tempfile.TemporaryDirectory() as work:
        machine = profile(options.dialect, work, options.radii)
        for path in paths:
            word, number, message, second = one(options, machine, path, work)
            counted[word] += 1
            if word == "refused":
                causes.setdefault(number, []).append((os.path.basename(path), message))
            if word in ("corrected", "unchanged"):
                seconds[second.split(":")[0]] += 1
            wrong += word == "WRONG"
            if options.list or word == "WRONG":
                print(f"{word:10} {os.path.basename(path)} {number} {message} {second}", flush=True)
    print(f"{options.dialect}: {len(paths)} programs: " + ", ".join(f"{count} {word}" for word, count in sorted(counted.items())))
    print("second judge: " + ", ".join(f"{count} {word}" for word, count in sorted(seconds.items())))
    for number, programs in sorted(causes.items(), key=lambda cause: -len(cause[1])):
        print(f"  {number} {len(programs)}: {programs[0][0]}: {programs[0][1]}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
