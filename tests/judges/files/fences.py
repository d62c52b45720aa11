"""Batch stays in its folder: links in its notebook, manifests that lead outside, two programs for one output, absurd counts.

Right: refused (exit status 1, 2 or 75) within seconds, without a panic or an abort, in bounded memory, and nothing outside the output
folder made, changed or removed.
"""

import json
import os
import random
import shutil

import blake3
from runner import broke_down, first_line, profile, program, read, tree, write

SECONDS, MEGABYTES = 30, 1000


def refused(judge, name, case, args, folder, ended, before, allowed=lambda path: path.startswith("outs/"), may_succeed=False):
    after = tree(folder)
    touched = sorted(p for p in set(before) | set(after) if before.get(p) != after.get(p) and not allowed(p))
    bad_end = ended.status not in ((0, 1, 2, 75) if may_succeed else (1, 2, 75))
    wrong = touched or bad_end or broke_down(ended) or ended.timed_out or ended.seconds > SECONDS or ended.peak_mb > MEGABYTES
    judge.judge(name, wrong, case, "exit status %d%s, %.1f s, %.0f MB, touched outside: %s; %s"
                % (ended.status, " (killed: too long)" if ended.timed_out else "", ended.seconds, ended.peak_mb, touched[:4], first_line(ended.err)),
                "refused soon, nothing outside touched" if not may_succeed else "nothing outside touched", args,
                [os.path.join(folder, "plan.jsonl"), os.path.join(folder, "mill.toml"), os.path.join(folder, "in", "a.nc")])


def stock(judge):
    folder = judge.folder("fence")
    profile(folder)
    rng = random.Random(8)
    for name in ("a.nc", "b.nc", "sub/c.nc"):
        write(os.path.join(folder, "in", name), program(rng, 20))
    write(os.path.join(folder, "elsewhere", "victim.nc"), "(A FILE OF SOMEBODY ELSE)\n")
    write(os.path.join(folder, "elsewhere", ".tmpvictim"), "(A FILE OF SOMEBODY ELSE)\n")
    write(os.path.join(folder, "elsewhere", "old", "victim.nc"), "(A FILE OF SOMEBODY ELSE)\n")
    return folder


ARGS = ["batch", "in", "-m", "mill.toml", "-O", "outs"]
PLAN = ["batch", "plan", "in", "-m", "mill.toml", "-O", "outs", "--manifest", "plan.jsonl"]
RUN = ["batch", "run", "--manifest", "plan.jsonl"]
MERGE = ["batch", "merge", "--manifest", "plan.jsonl"]


def links(judge):
    name = "notebook through links"
    stocked = stock(judge)
    judge.run(ARGS, cwd=stocked)
    inside = []
    for root, dirs, files in os.walk(os.path.join(stocked, "outs", ".vpost")):
        inside += [os.path.relpath(os.path.join(root, n), stocked) for n in dirs + files]
    inside = ["outs/.vpost"] + sorted(inside)
    judge.judge(name, len(inside) < 2, "undisturbed", str(inside), "a notebook", ARGS)
    folder = os.path.join(judge.work, "fence")

    def fresh(ran):
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(stocked, folder, symlinks=True)
        if not ran:
            shutil.rmtree(os.path.join(folder, "outs"))
    for place in inside:
        is_folder = os.path.isdir(os.path.join(stocked, place))
        targets = ["elsewhere", "a copy elsewhere", "nothing"] if is_folder else ["elsewhere/victim.nc", "a copy elsewhere", "nothing"]
        for target in targets:
            for ran in (True, False):
                for verb in ("batch", "plan and run"):
                    fresh(ran)
                    full = os.path.join(folder, place)
                    os.makedirs(os.path.dirname(full), exist_ok=True)
                    to = os.path.join(folder, target)
                    if target == "a copy elsewhere":
                        to = os.path.join(folder, "elsewhere", "copy")
                        if is_folder:
                            shutil.copytree(os.path.join(stocked, place), to)
                        else:
                            shutil.copy(os.path.join(stocked, place), to)
                    elif target == "nothing":
                        to = os.path.join(folder, "elsewhere", "not-there")
                    if os.path.isdir(full):
                        shutil.rmtree(full)
                    elif os.path.exists(full):
                        os.remove(full)
                    os.symlink(to, full)
                    write(os.path.join(folder, "in", "a.nc"), program(random.Random(99), 25))      # so that there is work
                    if verb == "plan and run":
                        judge.run(PLAN, cwd=folder)
                    before = tree(folder)
                    args = ARGS if verb == "batch" else RUN
                    ended = judge.run(args, cwd=folder, timeout=SECONDS)
                    refused(judge, name, "%s -> %s, %s, %s" % (place, target, "after a run" if ran else "before the first run", verb),
                            args, folder, ended, before, may_succeed=verb != "batch" and place.endswith("batch.jsonl"))
    name = "outputs through links"
    for place, to in (("outs/a.nc", "elsewhere/victim.nc"), ("outs/a.nc", "elsewhere/not-there.nc"), ("outs/sub", "elsewhere/old"),
                      ("outs/sub/c.nc", "elsewhere/victim.nc"), ("outs/a.nc", "in/b.nc"), ("outs/sub", "in/sub")):
        for force in ([], ["--force"]):
            fresh(False)
            os.makedirs(os.path.join(folder, os.path.dirname(place)), exist_ok=True)
            os.symlink(os.path.join(folder, to), os.path.join(folder, place))
            before = tree(folder)
            ended = judge.run(ARGS + force, cwd=folder, timeout=SECONDS)
            refused(judge, name, "%s -> %s %s" % (place, to, " ".join(force)), ARGS + force, folder, ended, before, may_succeed=True)


def manifests(judge):
    stocked = stock(judge)
    judge.run(PLAN, cwd=stocked)
    lines = read(os.path.join(stocked, "plan.jsonl")).decode().splitlines()
    head, rows = json.loads(lines[0]), [json.loads(row) for row in lines[1:]]
    folder = os.path.join(judge.work, "manifest")

    def asked(name, case, text, args=RUN, **keys):
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(stocked, folder, symlinks=True)
        write(os.path.join(folder, "plan.jsonl"), text)
        before = tree(folder)
        ended = judge.run(args, cwd=folder, timeout=SECONDS)
        refused(judge, name, case, args, folder, ended, before, **keys)

    def seal(below, head=head, **keys):
        """A manifest of these lines whose head has the hash and the number of them, as if `plan` had written it."""
        count = below.count("\n")
        return json.dumps({**head, "programs": count, "programs_blake3": blake3.hexdigest(below.encode()), **keys}, ensure_ascii=False) + "\n" + below

    def dump(rows, **keys):
        return seal("".join(json.dumps(r, ensure_ascii=False, separators=(",", ":")) + "\n" for r in rows), **keys)
    name = "manifest whose outputs lead outside"
    if not judge.judge(name, "output" not in rows[0] or len(rows) != 3, "planned", lines[1][:200], "three rows with an `output`", PLAN):
        return
    judge.judge(name, json.loads(dump(rows).splitlines()[0]) != head, "sealed again", "another hash than `plan` gives", "the hash of the rows", PLAN)
    elsewhere = os.path.join(folder, "elsewhere", "victim.nc")
    for output in ("../x.nc", "../elsewhere/victim.nc", elsewhere, "sub/../../x.nc", "./../x.nc", "sub/./../../x.nc", "..", ".", "", "/", "sub/..",
                   ".vpost/lock", ".vpost/journal/x.jsonl", "./.vpost/journal/x.jsonl", "a\0b.nc", "sub//..//..//x.nc",
                   "../outs/a.nc", "../in/a.nc", "x" * 5000, "a/" * 3000 + "x.nc"):
        for verb in (RUN, MERGE):
            asked(name, "%s of %r" % (verb[1], output if len(output) < 60 else output[:20] + "…"), dump([dict(rows[0], output=output)] + rows[1:]), verb)
    name = "manifest with two programs for one output"
    for second in (rows[0]["output"], rows[0]["output"].upper(), "./" + rows[0]["output"], "sub/../" + rows[0]["output"], "sub//c.nc", "SUB/C.NC"):
        for verb in (RUN, MERGE):
            asked(name, "%s of %s and %s" % (verb[1], [r["output"] for r in rows], second), dump(rows[:1] + [dict(rows[1], output=second)] + rows[2:]), verb)
    name = "manifest with absurd or broken values"
    huge = (2 ** 64 - 1, 2 ** 64, 2 ** 63, 10 ** 40, -1, 1.5, "NaN", None, [], {})
    for key in sorted(head):
        for value in huge:
            if head[key] == value or (head[key] is None and value is None):
                continue
            if key == "output" and value == "NaN":
                continue        # a name like any other
            asked(name, "head %s = %r" % (key, value), dump(rows, **{key: value}), may_succeed=value is None or value in ([], {}, "NaN"))
    for key in sorted(rows[0]):
        for value in huge:
            asked(name, "row %s = %r" % (key, value), dump([dict(rows[0], **{key: value})] + rows[1:]), may_succeed=value in ([], {}, "NaN", None))
    whole = "\n".join(lines) + "\n"
    for case, text in (("empty", ""), ("cut", whole[:len(whole) - 40]), ("first line only a brace", "{\n" + whole), ("NUL bytes", "\0" * 500),
                       ("not UTF-8", whole.encode() + b"\xff\xfe\n"), ("nested 100,000 deep", "[" * 100000), ("nested in a row", seal('{"output":' + "[" * 100000 + "\n")),
                       ("a line of 50 MB", lines[0] + "\n" + '{"output":"' + "x" * 50_000_000 + '"}\n'), ("a long number", seal('{"bytes":' + "9" * 100_000 + "}\n")),
                       ("rows twice", whole + "\n".join(lines[1:]) + "\n"), ("two heads", lines[0] + "\n" + whole)):
        asked(name, case, text)
    name = "absurd counts"
    most = 2 ** 64 - 1
    for shard in ("1/%d" % most, "%d/%d" % (most, most), "1/%d" % (most + 1), "%d/3" % most, "0/3", "4/3", "1/0", "-1/3", "1/-3", "1/1e9", "4294967296/4294967296", "1/4294967296", "1/", "/", "1",
                  "nan/3", "1/inf", "1/%d" % 10 ** 12, "%d/%d" % (10 ** 12 - 1, 10 ** 12), "auto/%d" % most, "1/" + "9" * 4000):
        asked(name, "--shard %s" % shard[:40], whole, RUN + ["--shard=" + shard])
    for shards in ("4294967295", "100000000", "1000000000000", str(most), str(most + 1), "0", "-1", "1e12", "nan"):
        for engine in ([], ["--missing", "hq"], ["--missing", "slurm"], ["--missing", "parallel"]):
            asked(name, "--shards %s %s" % (shards, " ".join(engine)), whole, MERGE + ["--shards=" + shards] + engine, may_succeed=shards == "100000000")
    for jobs in ("0", "-1", str(most), str(most + 1), "1000000000000", "1e3"):
        asked(name, "-j %s" % jobs, whole, RUN + ["-j", jobs], may_succeed=False)
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(stocked, folder, symlinks=True)
    for variable in ("HQ_TASK_ID", "SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX"):
        for value in (str(most), str(most + 1), "-1", "", "x", "1e3"):
            before = tree(folder)
            args = RUN + ["--shard", "auto/3"]
            ended = judge.run(args, cwd=folder, timeout=SECONDS, env=judge.environment(**{variable: value}))
            refused(judge, name, "%s=%s" % (variable, value), args, folder, ended, before)


def one_place(judge):
    name = "two programs for one output"
    stocked = stock(judge)
    rng = random.Random(9)
    for extra in ("A.NC", "two/a.nc", "two/A.nc", "cafe\u0301/x.nc", "caf\u00e9/x.nc"):
        write(os.path.join(stocked, "in2" if "two" in extra else "in", extra), program(rng, 22))
    folder = os.path.join(judge.work, "one-place")
    for case, given in (("a.nc and A.NC of one folder", ["in"]), ("two folders with a.nc", ["in", "in2/two"]), ("named twice elsewhere", ["in/a.nc", "in2/two/a.nc"]),
                        ("small and capital letters", ["in/a.nc", "in2/two/A.nc"])):
        for verb in (["batch"], ["batch", "plan"]):
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(stocked, folder)
            before = tree(folder)
            args = verb + given + ["-m", "mill.toml", "-O", "outs"] + (["--manifest", "plan.jsonl"] if len(verb) > 1 else [])
            ended = judge.run(args, cwd=folder, timeout=SECONDS)
            refused(judge, name, "%s, %s" % (" ".join(verb), case), args, folder, ended, before)
    for given in (["in/a.nc", "in/a.nc"], ["in/a.nc", "./in/a.nc"], ["in", "in/"], ["in/sub/../a.nc", "in/a.nc"]):
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(stocked, folder)
        os.remove(os.path.join(folder, "in", "A.NC"))
        before = tree(folder)
        args = ["batch"] + given + ["-m", "mill.toml", "-O", "outs"]
        ended = judge.run(args, cwd=folder, timeout=SECONDS)
        refused(judge, name + " (the same program)", " ".join(given), args, folder, ended, before, may_succeed=True)


def run(judge):
    links(judge)
    manifests(judge)
    one_place(judge)
