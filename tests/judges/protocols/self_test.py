"""Does the judge find what is wrong? Answers that nobody gave, on machines that are known; no binary is asked."""

import contextlib
import io
import random

import answers
import design
import judge
import kinds_lines
import kinds_volumes
import machine as parts
import table
import verdicts
from measure import Measure

NUMBERS = [{"name": "angle_urad", "value": 100.0, "u95": 2.0}]


def made(kind, truth, **changes):
    """A case of a kind whose machine has these parts (a function of machine and chance) instead of its own."""
    chance = random.Random("self-test")
    case = kind(chance)
    case.slip = changes.pop("slip", "")
    case.hidden.parts = truth(case.hidden, chance)
    measure = Measure(case.build(case.hidden, random.Random(1), random.Random(2)), 1.0, case.reading,
                      **{**case.how, "flip": "", **changes})
    return verdicts.Truth(case, measure), measure


def answer(verdict, causes=(), written=(), status=0, messages="", notes=()):
    told = [{"effect": name, "parameters": NUMBERS, "cannot_be_told_from": list(rivals),
             "shrink_predicted": {"mid": .9}} for name, rivals in causes]
    diagnosis = {"verdict": verdict, "causes": told, "leftover": {"rms_um": 1.0}, "notes": list(notes)}
    profile = "base\n" + "".join(f'[[effect]]\nid = "{name}"\n' for name in written)
    return answers.Answer(status, messages, None if status else diagnosis, profile, base="base\n")


def square(m, chance):
    part = parts.squareness("XY")
    part.size = 100.0
    return [part]


def yaw(m, chance):
    part = parts.angle(chance, m, m.order[0], 2 if m.order[0] != 2 else 0)
    part.size = 80.0
    return [part]


def bow(m, chance):
    part = parts.curve(chance, m, 0, 0)
    part.size = 20.0
    return [part]


def names():
    """Names: right, wrong, in the set, timid, an all-clear, messages, slips."""
    truth, _ = made(kinds_volumes.volume, square)
    yield "a squareness on a good design is determined", truth.determined
    right = verdicts.judge(truth, answer("NAMED", [("squareness.XY", [])], ["squareness.XY"]))
    yield "a right answer passes", not right["wrong"] and right["in_set"] and right["timid"] is False
    wrong = verdicts.judge(truth, answer("NAMED", [("scale.X", [])]))
    yield "a wrong name is found", wrong["wrong"] == ["scale.X"] and wrong["in_set"] is False
    two = [("squareness.XY", []), ("local.X", [])]
    beside = verdicts.judge(truth, answer("NAMED", two, [name for name, _ in two]))
    yield "one name too many is found", beside["wrong"] == ["local.X"]
    told = verdicts.judge(truth, answer("AMBIGUOUS", [("angular.ECX", ["squareness.XY"])], ["angular.ECX"]))
    yield "a set that holds the truth is no wrong name", not told["wrong"] and told["in_set"]
    put = verdicts.judge(truth, answer("AMBIGUOUS", [("angular.ECX", ["scale.X"])], ["angular.ECX"]))
    yield "a written cause without the truth beside it is found", put["wrong"] == ["angular.ECX"]
    timid = verdicts.judge(truth, answer("UNKNOWN"))
    yield "a timid answer is found", timid["timid"] and timid["in_set"] is False
    kept = verdicts.judge(truth, answer("NAMED", [("squareness.XY", [])]))
    yield "named and not written is timid", kept["timid"]
    yield "an all-clear over a gap is found", verdicts.judge(truth, answer("NO GAP"))["clear"]
    refused = verdicts.judge(truth, answer("", status=1, messages="error[VP0914]: rows repeat"))
    yield "a message on honest rows is found", refused["message"] == "VP0914"
    slipped, _ = made(kinds_lines.exchanged, lambda m, chance: [parts.play(0)], slip="dirs")
    asked = verdicts.judge(slipped, answer("", status=1, messages="error[VP0919]: columns"))
    yield "VP0919 on a slip is right", not asked["message"]
    written = verdicts.judge(slipped, answer("NAMED", [("backlash.X", [])], ["backlash.X"]))
    yield "what is written from a slip is found", written["wrong"] == ["backlash.X"]


def designs():
    """What a design can tell, and what it cannot."""
    lone, _ = made(kinds_lines.one_line, bow)
    ids = [facts[2] for facts in lone.facts.values()]
    yield "one line cannot tell a curve from an angle or a wave", not lone.determined and ids
    yield "and UNKNOWN there is not timid", verdicts.judge(lone, answer("UNKNOWN"))["timid"] is None
    two, _ = made(kinds_volumes.volume, yaw)
    part = two.parts[0]
    yield "three lines tell an angle", two.facts[part][0] > design.SINE
    silent, _ = made(kinds_volumes.scattered, bow)
    yield "scattered points without repeats know no noise", not silent.known_noise


def fields():
    """Harm and forecast of corrections with known fields."""
    truth, measure = made(kinds_volumes.volume, square)
    m = truth.case.hidden
    rows = verdicts.grid(m, m.travel, random.Random(3))
    true = [m.displacement(row) for row in rows]
    for share, harmful in ((1.0, False), (0.5, False), (0.0, False), (-1.0, True), (2.5, True)):
        found = verdicts.harm(m, rows, [[share * v for v in d] for d in true], 2.0)["harmed"]
        yield f"a correction of {share} of the truth {'harms' if harmful else 'is none that harms'}", found is harmful
    frame = [[0.1 * row.q[1], -0.1 * row.q[0], 5.0] for row in rows]
    yield "a turned frame harms nobody", not verdicts.harm(m, rows, frame, 2.0)["harmed"]
    scale = parts.scale(0)
    scale.size = 150.0
    m.parts = [*m.parts, scale]
    for written, harmful in ((["squareness.XY"], False), (["scale.X"], True), (["local.X"], True)):
        found = verdicts.harm(m, rows, true, 2.0, written=written)["harmed"]
        yield f"of two faults one undone as {written[0]} is judged for itself", found is harmful
    m.parts = m.parts[:1]
    values = measure.simulate(m, random.Random(4))
    full = verdicts.shrink(measure, m, values, [m.displacement(row) for row in measure.rows])
    none = verdicts.shrink(measure, m, values, [[0.0] * 3 for _ in measure.rows])
    yield "the truth shrinks the gap, nothing does not", full > 0.3 and none == 0


def periods():
    """A period that is off by more than a hundredth."""
    def screw(m, chance):
        part = parts.pitch(chance, 0, 12.7)
        part.size = 8.0
        return [part]
    truth, _ = made(kinds_lines.odd_period, screw)

    class Case:
        pass
    case = Case()
    case.truth = truth
    for value, bad in ((12.7, False), (12.75, False), (4.97, True)):
        told = answer("NAMED", [("pitch.X", [])], ["pitch.X"])
        told.causes[0]["parameters"] = [{"name": "pitch_mm", "value": value}]
        flags = verdicts.judge(truth, told)
        flags["written"] = told.written()
        judge.period_of(case, told, flags)
        yield f"a period of {value} for 12.7 is {'found' if bad else 'right'}", bool(flags["wrong"]) is bad


def tables():
    """The limits of the table."""
    clean = {"wrong": [], "harm": {"harmed": False}, "in_set": True, "timid": False, "forecast": True,
             "hopeful": False, "message": None, "clear": None}
    for change, missed in (({}, False), ({"wrong": ["scale.X"]}, True), ({"harm": {"harmed": True}}, True),
                           ({"in_set": False}, True), ({"timid": True}, True), ({"forecast": False}, True),
                           ({"hopeful": True}, True), ({"message": "VP0913"}, True), ({"clear": True}, True)):
        results = [{"kind": "k", "answers": {"plain": {**clean, **change}}}]
        with contextlib.redirect_stdout(io.StringIO()):
            found = table.show(results, ("plain",))
        what = "misses a limit" if missed else "is content"
        yield f"the table {what} with {change or 'nothing wrong'}", found is missed


def run():
    """True where something was not found."""
    failed = False
    for group in (names, designs, fields, periods, tables):
        for what, good in group():
            if not good:
                failed = True
                print(f"self-test FAILED: {what}")
    print("self-test: " + ("failed" if failed else "passed"))
    return failed
