"""Shows that the judge passes what is right and finds what is wrong: outputs of a plain corrector, damaged one by one."""

import re

import numpy as np

from common.trial import Trial

import blocks
import contour
import control
import judge


def cases(count, dialect, without="corners beside arcs"):
    out, n = [], 0
    while len(out) < count:
        case = contour.Case(5, n, dialect)
        n += 1
        if case.good and without not in case.what:
            case.spec.update(resolution=0.0001, tolerance=2.0)
            # The corrector below leads ends alone: its machine is a better one.
            for data in case.spec["tables"].values():
                data["rows"] = (0.3 * np.array(data["rows"])).tolist()
            case.spec["squareness"] = {k: 0.3 * v for k, v in case.spec["squareness"].items()}
            out.append(case)
    return out


def corrected(case, damage=None):
    """Ends of blocks led to their places, words that are there and no others; centres as far from both ends as they were."""
    out, error = [], lambda p: judge.real(case, p[None])[0] - p
    for b in blocks.read(case.text):
        text = b.line
        if b.motion is not None:
            end = np.nan_to_num(b.end)
            end = end - error(end - error(end))
            text = re.sub(r"([XYZ])[-+.\d]+", lambda m: "%s%.4f" % (m[1], end["XYZ".index(m[1])]), text)
            if b.centre is not None:
                axes = list(blocks.PLANES[b.plane][:2])
                start = b.start - error(b.start - error(b.start))
                middle = b.centre + (start + end - b.start - b.end)[axes] / 2 - start[axes]
                for n, v in zip(axes, middle):
                    text = re.sub(r"%s[-+.\d]+" % "IJK"[n], "%s%.4f" % ("IJK"[n], v), text)
        out.append(damage(b, text, case) if damage else text)
    return "\n".join(out) + "\n"


def near(case, b, across=False):
    """Words of the plane's axes (or of the one across it) where the block stands, some micrometres on."""
    chosen = blocks.PLANES[b.plane][2:] if across else blocks.PLANES[b.plane][:2]
    return " ".join("%s%.4f" % ("XYZ"[n], b.end[n] + 0.003) for n in chosen)


def once(change):
    """A damage of the first block that `change` has another text for."""

    def damage_of(case):
        done = []

        def damage(b, text, case):
            new = None if done else change(b, text, case)
            if new:
                done.append(b)
            return new or text

        text = corrected(case, damage)
        return text if done else None

    return damage_of


def stands(b):
    return b.motion is not None and not b.in_plane and not np.isnan(b.end).any()


def gains_under(b, text, case):
    return text + " " + near(case, b) if b.side and stands(b) and b.motion == 1 else None


def gains_after(b, text, case):
    """The retract behind a bare G40: the only feeds at F300."""
    return text + " " + near(case, b) if stands(b) and "F300" in text else None


def loses(b, text, case):
    return re.sub(r" [XYZIJK][-.\d]+", "", text) + " " + near(case, b, True) if b.side and b.in_plane else None


def corner_aside(b, text, case):
    axis = "XYZ"[blocks.PLANES[b.plane][0]]
    move = lambda m: "%s%.4f" % (axis, float(m[1]) + 0.012)
    return (
        re.sub(r"%s([-.\d]+)" % axis, move, text)
        if b.side and b.in_plane and b.centre is None and "F400" not in text and re.search(axis, text)
        else None
    )


def other_side(b, text, case):
    return re.sub("G4([12])", lambda m: "G4" + "21"[int(m[1]) - 1], text) if re.search("G4[12]", text) else None


def late_cancel(b, text, case):
    return re.sub(r"G40 (?=G[01] )", "", text) if re.search(r"G40 G[01] ", text) else None


def short_start(b, text, case):
    """A block of three micrometres before the motion that leads on: the control takes its direction from it."""
    return "G1 %s\n%s" % (near(case, b), text) if b.side and stands(b) and b.motion == 1 else None


DAMAGES = (gains_under, gains_after, loses, corner_aside, other_side, late_cancel, short_start)


def main():
    t = Trial()
    for dialect in judge.RULES:
        chosen = cases(10, dialect)
        wrong = [judge.compare(c, corrected(c))[0] for c in chosen]
        t.ask(
            not any(wrong),
            "%s: right outputs that pass: %d of %d %s" % (dialect, sum(not w for w in wrong), len(chosen), [w for w in wrong if w][:1]),
        )
        for damage in DAMAGES:
            bad = [(c, x) for c, x in ((c, once(damage)(c)) for c in chosen) if x]
            found = [judge.compare(c, x)[0] for c, x in bad]
            # Words that a rule for words finds are to be wrong by the centre's way as well, most of them.
            by_path = sum(not all(w.startswith("words") for w in f) for f in found)
            t.ask(
                all(found),
                "%s, %s: found %d of %d, %d by the path alone"
                % (dialect, damage.__name__.replace("_", " "), sum(map(bool, found)), len(bad), by_path),
            )
    agree(t)
    return t.status()


def agree(t):
    """Sinumerik's NORM with G450 and LinuxCNC differ at both ends of a contour alone: in between one reader has to confirm the other."""
    worst, places = 0.0, 0
    for case in cases(8, "linuxcnc", "a step at a corner"):
        theirs = control.linuxcnc(case.text, case.spec["radius"])
        mine = np.concatenate([p for feed, p in control.by_manual(blocks.read(case.text), case.spec["radius"], "NORM") if feed])
        run = []
        for feed, points in theirs + [(False, None)]:
            run += [points] if feed else []
            if not feed:
                for points in run[5:-4]:
                    for p in points[:: max(1, len(points) // 20)]:
                        k = np.argmin(np.linalg.norm(mine - p, axis=1))
                        worst, places = max(worst, to_line(p, mine[max(k - 1, 0) : k + 2])), places + 1
                run = []
    t.ask(places > 200 and worst < 5e-4, "LinuxCNC's own and the reader of manuals agree at %d places: %.2f um" % (places, worst * 1e3))


def to_line(p, line):
    a, d = line[:-1], np.diff(line, axis=0)
    s = np.clip(((p - a) * d).sum(axis=1) / np.maximum((d * d).sum(axis=1), 1e-30), 0, 1)
    return float(np.linalg.norm(p - a - s[:, None] * d, axis=1).min())
