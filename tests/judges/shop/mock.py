"""A right corrector, slow and plain, and wrong ones: what the self-test feeds the judge."""

import numpy as np

from reader import Reader


def touches(case, datum):
    """Commands and tool vector of the touch of each axis, from what the profile says."""
    said = datum.touched_at or {}
    said = {k: said for k in "XYZ"} if "at" in said else said
    out = []
    for k in "XYZ":
        one = said.get(k, {"at": datum.at, "tool": 0.0})
        tool = one["tool"]
        tool = case.spec["lengths"].get(tool, tool) if isinstance(tool, str) else tool
        out.append((np.atleast_2d(one["at"]), np.array([0.0, 0.0, -tool] if isinstance(tool, float) else tool)))
    return out


def found(case, datum, angles=None, touched=None):
    """The error in a zero, along the machine's axes as they stood."""
    if datum.zero == "true":
        return np.zeros(3)
    angles = datum.angles if angles is None else angles
    return np.array([case.machine.error(q, angles, tool)[:, n].mean() for n, (q, tool) in enumerate(touched or touches(case, datum))])


def seen(case, datum, error, angles=None):
    angles = datum.angles if angles is None else angles
    count = max([np.size(v) for v in angles.values()], default=1)
    return case.machine.in_workpiece(angles, np.broadcast_to(error, (count, 3)), vector=True)


def right(case, datum, angles):
    return seen(case, datum, found(case, datum))


def wrong_sign(case, datum, angles):
    return -right(case, datum, angles)


def not_counted(case, datum, angles):
    return np.zeros((1, 3))


def not_turned(case, datum, angles):
    """The error stays with the machine while the table turns."""
    return seen(case, datum, found(case, datum), angles)


def angle_forgotten(case, datum, angles):
    return seen(case, datum, found(case, datum, {}), {})


def at_the_zero(case, datum, angles):
    return seen(case, datum, found(case, datum, touched=[(np.array([datum.at]), np.zeros(3))] * 3))


def tool_forgotten(case, datum, angles):
    return seen(case, datum, found(case, datum, touched=[(q, np.zeros(3)) for q, _ in touches(case, datum)]))


def one_place(case, datum, angles):
    return seen(case, datum, found(case, datum, touched=touches(case, datum)[:1] * 3))


def first_zero(case, datum, angles):
    return right(case, next(iter(case.datums.values())), angles)


def true_as_touched(case, datum, angles):
    if datum.zero == "touched":
        return right(case, datum, angles)
    return case.machine.error(np.array([datum.at]), {}, [0.0, 0.0, 0.0])


FAULTS = (wrong_sign, not_counted, not_turned, angle_forgotten, at_the_zero, tool_forgotten, one_place, first_zero, true_as_touched)


def corrected(case, error, damage=None):
    """The program as lines whose ends are right if `error` is. `damage(number of the move, targets)` may spoil these."""
    lines, state = ["G21 G90"], None
    for d in case.datums.values():
        if d.plain == "program":
            lines.append("G10 L2 P%d X%.3f Y%.3f Z%.3f" % (int(d.name[1:]) - 53, *d.at))
    for number, m in enumerate(Reader(case).read(case.text)):
        datum = case.datums[m.offset]
        now = (m.offset, m.tool[2], m.tip_control)
        if now != state:
            name = next((h for h, v in case.spec["lengths"].items() if v == -m.tool[2]), None)
            lines.append("%s %s" % (m.offset, ("G43.4 " if m.tip_control else "G43 ") + name if name else "G49"))
            state = now
        known = ~np.isnan(m.points).any(axis=0)
        points = np.where(known, m.points, 0.0)
        q = case.ideal.joints(points + m.tool, m.angles, m.tool) if m.tip_control else points
        target = case.ideal.in_workpiece(m.angles, q + case.ideal.reach(m.angles, m.tool, len(q))) + error(case, datum, m.angles)
        q = case.machine.solved(damage(number, target) if damage else target, m.angles, m.tool)
        if m.tip_control:
            q = case.ideal.in_workpiece(m.angles, q + case.ideal.reach(m.angles, m.tool, len(q))) - m.tool
        words = q - np.array(datum.at) + m.tool
        for k in [*range(3, len(words) - 1, 3), len(words) - 1] if m.feed else [-1]:
            text = ["%s%.4f" % (x, v) for x, v, here in zip("XYZ", words[k], known) if here]
            text += ["%s%.6f" % (x, v[k]) for x, v in m.angles.items()]
            lines.append(("G1 " if m.feed else "G0 ") + " ".join(text))
    return "\n".join(lines) + "\n"
