"""Does the judge find what it looks for? A careless command must fail in every check; a careful one must not lose to a power cut."""

import os
import stat
import tempfile


# What the careless command must be caught at; the text is the beginning of a check's name.
CAUGHT = {
    "power_cut": ["power cut in batch, old or whole new", "power cut in batch, same command completes", "power cut in single runs, durable after exit 0",
                  "outputs and journal damaged by a cut"],
    "moving_input": ["input changed while it is read", "input changed while it is read without rest"],
    "slips": ["output onto an input", "two outputs in one place", "-o through a link", "mode of what was there kept", "closed, full or broken standard output"],
    "fences": ["notebook through links", "manifest whose outputs lead outside", "manifest with two programs for one output", "absurd counts"],
    "terminal": ["program text in messages", "names of files", "values on the command line", "names in profiles", "run ids and columns of measurements",
                 "a machine's name brings nothing into the program"],
    "absurd": ["linear time", "NaN and infinity in options", "NaN and infinity in profiles", "resolution", "absurd options", "NaN and infinity in tables"],
    "endless": ["work without end refused soon", "SIGINT and SIGTERM act within a second"],
}


def command(folder, name):
    path = os.path.join(folder, name)
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "careless.py")) as src, open(path, "w") as out:
        out.write(src.read())
    os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
    return path


def run(keep, only, seed):
    import judge as judging
    fine = True
    with tempfile.TemporaryDirectory(prefix="judge-files-self-") as folder:
        for name in only:
            found = judging.judged(command(folder, "careless"), 10, seed, os.path.join(keep, "careless"), [name], silent=True)
            for wanted in CAUGHT[name]:
                wrong = sum(len(w) for check, w in found.wrong.items() if check.startswith(wanted))
                skipped = any("SKIPPED" in n for n in found.notes) and name == "power_cut" and wanted.startswith("power cut")
                fine &= bool(wrong) or skipped
                print("self-test %-8s %s: %d wrong answers of the careless command found" % ("ok" if wrong else "skipped" if skipped else "FAILED", wanted, wrong))
        if "power_cut" in only:
            found = judging.judged(command(folder, "careful"), 10, seed, os.path.join(keep, "careful"), ["power_cut"], silent=True)
            for check in found.wrong:
                if ", old or whole new" in check or "durable" in check:
                    wrong = len(found.wrong[check])
                    fine &= not wrong
                    print("self-test %-8s %s: %d false alarms about the careful command in %d" % ("FAILED" if wrong else "ok", check, wrong, found.asked[check]))
        if "moving_input" in only:
            found = judging.judged(command(folder, "careful"), 10, seed, os.path.join(keep, "careful"), ["moving_input"], silent=True)
            for check in ("input changed while it is read", "input changed while it is read without rest"):
                wrong = len(found.wrong.get(check, ()))
                fine &= not wrong
                print("self-test %-8s %s: %d false alarms about the careful command in %d" % ("FAILED" if wrong else "ok", check, wrong, found.asked.get(check, 0)))
    return fine
