#!/usr/bin/env python3
"""Judge of tilted working planes: where the tip really goes in the workpiece, with the output, on a crooked machine.

    judge.py --vpost target/release/vpost --count 300 [--seed 1] [--kind hh] [--damage 0.5] [--refusals] [--keep DIR]
    judge.py --vpost target/release/vpost --self-test

Exit status 1 where something is found. What is asked stands in README.md.
"""

import collections
import json
import math
import os
import random
import re
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, options  # noqa: E402  before numpy

import numpy as np  # noqa: E402

import damages  # noqa: E402
import generate  # noqa: E402
import machine  # noqa: E402
import reader  # noqa: E402
import refusals  # noqa: E402

WHOLE = {68.2, 53.1, 53.6, 69.0, 53.0, 28.0, 4.0, 10.0, 49.0, 80.0}

UPRIGHT = 5e-6  # rad; VP0232


def limit_mm(spec, inch):
    """Tolerance, and half an output step of each of X, Y and Z."""
    steps = [0.00254 if inch else spec["axes"][k]["resolution"] for k in "XYZ"]
    return spec["tolerance"] * 1e-3 + 0.5 * math.hypot(*steps)


def in_frame(m, motion, u):
    """Where the real tip is, in the coordinates of the motion's frame, for words u (n, 3) of it."""
    lift = np.array([0.0, 0.0, motion.tool])
    if motion.plane is None:
        real = m.tip(u + motion.offset + lift, motion.theta, motion.tool)
        # The same place in axis commands of the ideal machine, whose centres are those of the profile.
        true = machine.Machine({**m.spec, "control_centres": {k: m.spec["rotary"][k]["centre"] for k in m.rotary}})
        return true.command(real, motion.theta, motion.tool) - motion.offset - lift
    zero, turn = motion.plane
    q = m.command(motion.offset + zero + u @ turn.T, motion.theta, motion.tool)
    return (m.tip(q, motion.theta, motion.tool) - motion.offset - zero) @ turn


def groups(blocks, numbers):
    """Blocks of the output under the block of the input that they come from; what stands before the first is left out."""
    out, now = collections.OrderedDict(), None
    for number, words, motions in blocks:
        if number in numbers:
            if number in out:
                raise reader.Unreadable("N%d twice" % number)
            now = out.setdefault(number, [])
        if now is not None:
            now.append((words, motions))
    return out


def process(words):
    codes = {v for k, v in words if k == "G"}
    if codes & WHOLE:
        return [(k, v) for k, v in words if k != "N"]
    return [(k, v) for k, v in words if k not in "NXYZIJKRFABC" and not (k == "G" and v in (0, 1, 2, 3))]


def leaning(m, motion):
    """Angle between the tool and the normal of the plane that its motion is in, rad: pi where it points the other way."""
    if motion.plane is None or None in motion.theta.values():
        return 0.0
    tool, normal = m.direction(motion.theta), motion.plane[1][:, 2]
    return float(np.linalg.norm(np.cross(tool, normal))) if tool @ normal > 0 else math.pi


def same_frame(a, b):
    """The output's motion lies in the input's plane, with its tool and work offset."""
    if (a.plane is None) != (b.plane is None) or a.tool != b.tool or not np.array_equal(a.offset, b.offset):
        return False
    return a.plane is None or (np.array_equal(a.plane[0], b.plane[0]) and np.array_equal(a.plane[1], b.plane[1]))


def compare(m, text_in, text_out, start=None):
    """[(what, block, text)] and the largest share of the limit used."""
    try:
        return compared(m, text_in, text_out, start)
    except reader.Unreadable as why:
        return [("unreadable", 0, str(why))], 0.0


def compared(m, text_in, text_out, start):
    found, worst = [], 0.0
    try:
        blocks_in = reader.read(text_in, m, start)
    except reader.Unreadable as why:
        return [("judge", 0, "input: %s" % why)], 0.0
    try:
        blocks_out = reader.read(text_out, m, start)
        numbers = {n for n, _, _ in blocks_in if n is not None}
        groups_out = groups(blocks_out, numbers)
    except (reader.Unreadable, KeyError, TypeError) as why:
        return [("unreadable", 0, str(why))], 0.0
    if list(groups_out) != [n for n, _, _ in blocks_in]:
        return [("structure", 0, "other blocks, or in another order")], 0.0
    limit = limit_mm(m.spec, bool(re.search(r"\bG20\b", text_in)))
    stood = None  # where the tool really stands, in words of the output; and whether a rapid of some axes brought it there
    partial = False
    for number, words, ideal in blocks_in:
        parts = groups_out[number]
        made = [x for _, motions in parts for x in motions]
        was, now = process(words), [x for w, _ in parts for x in process(w)]
        hole = any(x.kind == "rapid" for x in ideal) and any(x.kind != "rapid" for x in ideal)
        if hole and not any(k == "G" and v in (81, 83) for w, _ in parts for k, v in w):
            # Written as moves: the pecks are judged below, by depth.
            was = [(k, v) for k, v in was if (k, v) not in (("G", 81), ("G", 83)) and k != "Q"]
        if (set(was) != set(now)) if hole else (was != now):
            found.append(("process", number, "%s became %s" % (was, now)))
        turned_in = [(k, v) for k, v in words if k in "ABC"]
        turned_out = [(k, v) for w, _ in parts for k, v in w if k in "ABC"]
        if len(turned_in) != len(turned_out) or any(a != c or abs(b - d) > 0.0005 + 1e-9 for (a, b), (c, d) in zip(turned_in, turned_out)):
            found.append(("rotary", number, "%s became %s" % (turned_in, turned_out)))
        if not ideal:
            if made:
                found.append(("structure", number, "motion where there was none"))
            continue
        if not made:
            found.append(("structure", number, "no motion left"))
            continue
        if any(not same_frame(ideal[0], x) for x in made):
            # Another plane in the output: its places are seen from the plane of the input.
            made = [seen_from(m, ideal[0], x) for x in made]
        lean = max(leaning(m, x) for x in made)
        if lean > UPRIGHT:
            found.append(("upright", number, "the tool leans by %.1f urad" % (lean * 1e6)))
        feeds_in = [x for x in ideal if x.kind != "rapid"]
        feeds_out = [x for x in made if x.kind != "rapid"]
        if not feeds_in:
            if feeds_out:
                found.append(("structure", number, "a rapid became a feed"))
                continue
            if [k for k, _ in words if k in "XYZ"] != [k for w, _ in parts for k, _ in w if k in "XYZ"]:
                found.append(("process", number, "a rapid moves other axes"))
            last, aim = made[-1], ideal[-1]
            if not np.isnan(last.u1).any() and not np.isnan(aim.u1).any():
                off = np.abs(real(m, ideal[-1], last, last.u1[None])[0] - aim.u1)
                named = max(off["XYZ".index(k)] for k in aim.named)
                worst = max(worst, named / limit)
                if named > limit:
                    found.append(("rapid", number, "%.2f um, limit %.2f" % (named * 1e3, limit * 1e3)))
            partial = len(aim.named) < 3
            continue
        if not feeds_out:
            found.append(("structure", number, "a feed became a rapid"))
            continue
        if not hole and len(feeds_out) != len(made):
            found.append(("structure", number, "a rapid inside a feed"))
        for x in feeds_out:
            if feeds_in[0].feed is None or abs((x.feed or 0.0) - feeds_in[0].feed) > 1e-6:
                found.append(("feed", number, "%s became %s" % (feeds_in[0].feed, x.feed)))
                break
        one = feeds_in[0]
        total, done, reached = sum(max(x.length(), 1e-9) for x in feeds_out), 0.0, 0.0
        off_start = None
        for x in feeds_out:
            if hole and done:
                # A peck begins where the ones before have been, however the control came there.
                s0 = one.nearest(real(m, one, x, x.u0[None]), np.zeros(1))[1][0]
                if s0 > reached + limit / one.length():
                    found.append(("path", number, "a rapid inside the material"))
                    break
                reached = s0
            n = int(min(400, max(16, x.length() / 0.7)))
            s = np.linspace(0, 1, n + 1)
            u = real(m, one, x, x.at(s))
            d, at = one.nearest(u, (done + s * x.length()) / total)
            if off_start is None:
                off_start = d[0]
            allowed = np.full(len(d), limit)
            if off_start > limit and partial and not hole:
                allowed = allowed + off_start * (1 - at)
            if hole and one.peck and "cycle" not in x.__dict__ and (at[-1] - at[0]) * one.length() > one.peck + 0.5:
                found.append(("path", number, "a peck of %.3f mm" % ((at[-1] - at[0]) * one.length())))
                break
            share = float(np.max(d / allowed))
            worst = max(worst, share)
            if share > 1:
                k = int(np.argmax(d / allowed))
                found.append(("path", number, "%.2f um off, limit %.2f, at %.0f %% of the block" % (d[k] * 1e3, limit * 1e3, at[k] * 100)))
                break
            if np.any(at < reached - 2 * limit / max(one.length(), limit) - 1e-3):
                found.append(("path", number, "goes back"))
                break
            reached = max(reached, float(np.max(at)))
            done += x.length()
        else:
            end = np.linalg.norm(real(m, one, feeds_out[-1], feeds_out[-1].u1[None])[0] - one.u1)
            begin = np.linalg.norm(real(m, one, feeds_out[0], feeds_out[0].u0[None])[0] - one.u0)
            worst = max(worst, end / limit)
            if end > limit or (begin > limit and not partial):
                found.append(("path", number, "end %.2f um, start %.2f um off, limit %.2f" % (end * 1e3, begin * 1e3, limit * 1e3)))
        if not hole:
            partial = False
        else:
            aim, last = ideal[-1].u1, made[-1].u1
            off = np.linalg.norm(real(m, one, made[-1], last[None])[0] - aim)
            # Behind a hole the tool stands at another height than the hole's middle was corrected for.
            if off > limit + 0.05:
                found.append(("rapid", number, "%.2f um behind the hole" % (off * 1e3)))
            partial = True
    return found, worst


def real(m, inp, motion, u):
    """Real places in the coordinates of the input's frame, for words u of a motion of the output."""
    here = in_frame(m, motion, u)
    if motion.__dict__.get("into") is None:
        return here
    r, shift = motion.into
    return here @ r.T + shift


def seen_from(m, inp, motion):
    if inp.plane is None or motion.plane is None:
        raise reader.Unreadable("axis words for a plane, or the other way round")
    zero, turn = inp.plane
    zero2, turn2 = motion.plane
    motion.into = (turn.T @ turn2, turn.T @ (zero2 + motion.offset - zero - inp.offset))
    return motion


def one(case):
    if isinstance(case.number, str):
        refusals.asked(case)
        return
    spec, text, align = generate.case(case.options.seed, case.number, case.options.kind)
    m = machine.Machine(spec)
    flags = "-m", generate.write_profile(spec, case.folder), "--zero", "true"
    case.write("in.nc", text)
    case.write("spec.json", json.dumps(spec))
    case.tally.update(["programs", "chain " + spec["kind"], "angles " + align])
    done = case.correct(*flags)
    if not done:
        if spec["state"] == "perfect" and case.refused:
            case.find("perfect", "refused by " + " | ".join([case.refused[0], *case.refused[1]]))
        return
    output, _ = done
    if spec["state"] == "perfect":
        case.tally["perfect"] += 1
        if output != text:
            case.find("perfect", "not the same bytes")
    found, worst = compare(m, text, output)
    case.figures["share of the limit, " + spec["kind"]] = worst
    for what, block, why in found[:3]:
        case.find(what, "N%s %s (%s, %s)" % (block, why, spec["kind"], align))
    before = [float(re.search(r"([\d.]+) um", w).group(1)) for k, _, w in compare(m, text, text)[0] if k == "path" and " um" in w]
    case.figures["before, um"] = max(before, default=0.0)
    case.tally["checked"] += 1
    case.check(bool(found), *flags)
    if not found and spec["state"] != "perfect":
        damaged(case, m, text, output, flags)


def damaged(case, m, text, output, flags):
    """Of a share of the outputs, damages: those that do harm `check` has to find."""
    rng = random.Random("damage %d-%d" % (case.options.seed, case.number))
    if rng.random() > case.options.damage:
        return
    for name, bad in damages.all_of(rng, m, text, output):
        found, _ = compare(m, text, bad)
        if not found:
            case.tally["damage without harm: " + name] += 1
            continue
        path = case.write("bad.nc", bad)
        case.tally["damage: " + name] += 1
        if case.run("check", case.folder / "in.nc", path, *flags).status == 0:
            case.find("damage-missed", "%s (%s)" % (name, found[0][0]))
        path.unlink()


def main():
    words = options.parser(__doc__, 200, "first", "refusals")
    words.add_argument("--kind", choices=list(generate.CHAINS))
    words.add_argument("--damage", type=float, default=0.5, help="share of the programs whose outputs are damaged")
    words.add_argument("--say", action="store_true", help="print the message of every refusal")
    given = words.parse_args()
    if given.self_test:
        import self_test

        return self_test.main(given.vpost)
    return cases.campaign(given, one, [*cases.asked(given), *(refusals.ROWS if given.refusals else ())])


if __name__ == "__main__":
    sys.exit(main())
