"""Programs under a dialect that is not theirs: which are corrected, and go elsewhere on their own control?

Every program of the corpus and every sample is corrected under each other dialect of mills. What ends with exit status 0
is read by the program's own dialect, before and after (`vpost check`): a path that differs by more than the output's
rounding means that the wrong dialect read something else, and did not say so. There must be none but those of AMBIGUOUS,
in which nothing contradicts the dialect that was named.

    python3 judge.py --vpost target/release/vpost [--only DIALECT] [--self-test]
"""

import argparse
import glob
import json
import os
import re
import shutil
import sys
import tempfile

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import folders  # noqa: E402
from common.command import run  # noqa: E402

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "../../.."))
PROFILE = os.path.join(ROOT, "tests/profiles/corpus.toml")
MILLS = ["fanuc", "haas", "mitsubishi", "okuma", "mach", "perspektiva", "linuxcnc", "balt-system", "sinumerik", "centroid"]
# Another meaning on both controls, each of them sound: only who named the dialect can know.
AMBIGUOUS = {
    "peck-with-chip-breaking.nc": "how far G73 retreats is a parameter of the control",
    "tool-length-by-h0.nc": "G43 H0 is the tool in the spindle on LinuxCNC, no length elsewhere",
}
# Controls differ in the decimals they write: more than that, and less than any other meaning.
ROUNDING_UM = 50.0


def programs(dialect):
    corpus = glob.glob(os.path.join(ROOT, "tests/corpus", dialect, "accept", "*"))
    return sorted(path for path in corpus + glob.glob(os.path.join(ROOT, f"samples/*_{dialect}.*")) if os.path.isfile(path))


def batch(vpost, folder, dialect, out):
    """Corrects a folder under a dialect: what became of each program."""
    results = out + ".jsonl"
    command = [vpost, "batch", folder, "-m", PROFILE, "--zero", "true", "-d", dialect, "-O", out, "-q", "--results", results, "--pattern", "*.*"]
    run(*command, folder=ROOT, seconds=600)
    with open(results, encoding="utf-8") as file:
        return [json.loads(line) for line in file]


def off_um(vpost, program, made, dialect):
    """By how much the corrected program leads elsewhere on its own control, um; what is said where it cannot be read."""
    with open(made, "rb") as file:
        text = file.read()
    # The mark is written as the dialect that was named writes comments.
    text = re.sub(rb"(?m)^[^\n]*CORRECTED BY VPOST[^\n]*\n", b"", text)
    with open(made, "wb") as file:
        file.write(text)
    status, output, errors = run(vpost, "check", program, made, "-m", PROFILE, "--zero", "true", "-d", dialect, folder=ROOT)
    if status == 0:
        return 0.0, ""
    found = re.search(r"after: .* up to\s+([0-9.]+) um", output + errors)
    said = (errors or output).strip().split("\n")[0]
    return (float(found.group(1)) if found else float("inf")), said


def judge(vpost, only):
    wrong, known, corrected, tried, refused = [], [], 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for own in MILLS:
            source = os.path.join(folder, "source", own)
            os.makedirs(source)
            for path in programs(own):
                shutil.copy(path, source)
        for named in MILLS:
            print(f"under {named}: so far {tried} tried, {len(wrong)} wrong", flush=True)
            for own in MILLS:
                if own == named or (only and named != only):
                    continue
                source, out = os.path.join(folder, "source", own), os.path.join(folder, f"{own}.{named}")
                for row in batch(vpost, source, named, out):
                    tried += 1
                    refused += row["status"] == "refused"
                    if row["status"] != "corrected":
                        continue
                    corrected += 1
                    name = row["output"]
                    um, said = off_um(vpost, os.path.join(source, name), os.path.join(out, name), own)
                    if um > ROUNDING_UM:
                        (known if name in AMBIGUOUS else wrong).append((own, named, name, um, said))
    print(f"{tried} programs under another dialect: {refused} refused, {corrected} corrected")
    for own, named, name, um, said in known:
        print(f"  ambiguous: {name} of {own} under {named}: {AMBIGUOUS[name]}")
    for own, named, name, um, said in wrong:
        print(f"  WRONG: {name} of {own} under {named}: {um:.0f} um: {said}")
    print(f"{len(wrong)} wrong, {len(known)} ambiguous")
    return not wrong and corrected > 0


def self_test(vpost):
    """A program that is damaged by a millimetre is found, one that is left alone is not."""
    program = os.path.join(ROOT, "samples/plate_linuxcnc.nc")
    with tempfile.TemporaryDirectory() as folder:
        made = os.path.join(folder, "made.nc")
        assert run(vpost, program, "-m", PROFILE, "--zero", "true", "-d", "linuxcnc", "-o", made, "-q", folder=ROOT).status == 0
        whole, _ = off_um(vpost, program, made, "linuxcnc")
        with open(made, encoding="utf-8") as file:
            text = file.read()
        damaged = re.sub(r"(?m)^(N?\d* ?G0?1 .*X)(-?\d+)", lambda m: f"{m.group(1)}{int(m.group(2)) + 1}", text, count=1)
        assert damaged != text, "nothing was damaged"
        folders.put(folder, "made.nc", damaged)
        moved, said = off_um(vpost, program, made, "linuxcnc")
    print(f"self-test: as it was {whole:.1f} um, damaged {moved:.1f} um: {said}")
    return whole == 0.0 and moved > ROUNDING_UM


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vpost", required=True)
    parser.add_argument("--only", help="the dialect that is named")
    parser.add_argument("--self-test", action="store_true")
    arguments = parser.parse_args()
    binary = os.path.abspath(arguments.vpost)
    sys.exit(0 if (self_test(binary) if arguments.self_test else judge(binary, arguments.only)) else 1)
