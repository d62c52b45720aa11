"""Slips of the hand: an output onto an input or another output, links, modes, closed and full standard output, leftovers of killed runs.

Each command that writes files is asked to write each of its outputs over each of its inputs and over its other outputs, the place spelt
in five ways: as it is, with `./`, by way of `..`, as a symbolic link, as a hard link. Right: not exit status 0, and every file as it
was. Where documents allow an output to be an input (`-o` onto the program) the whole new program stands there instead.
"""

import os
import random
import shutil
import signal
import stat
import subprocess
import time

from runner import REPOSITORY, broke_down, first_line, profile, program, read, tree, write

SAMPLES = os.path.join(REPOSITORY, "samples")


def spellings(folder, name):
    """Other ways to say `name`, made as needed; the folder must be fresh."""
    yield "as it is", name
    yield "./", "./" + name
    yield "by ..", os.path.join("..", os.path.basename(folder), name)
    if os.path.exists(os.path.join(folder, name)):
        os.symlink(name, os.path.join(folder, "soft"))
        yield "symbolic link", "soft"
        os.link(os.path.join(folder, name), os.path.join(folder, "hard"))
        yield "hard link", "hard"
    os.symlink(".", os.path.join(folder, "here"))
    yield "linked folder", "here/" + name


def scenes():
    """Name, files to copy, arguments, outputs (option and usual name), inputs, and pairs that are allowed."""
    mill = ["mill.toml", "x.csv", "y.csv", "z.csv"]
    yield ("correct", ["part.nc"], ["part.nc", "-m", "mill.toml"], {"-o": "out.nc", "--summary": "sum.json"}, ["part.nc"] + mill,
           [("-o", "part.nc")])
    yield ("check", ["part.nc", "fine.nc"], ["check", "part.nc", "fine.nc", "-m", "mill.toml"], {"--html": "page.html"},
           ["part.nc", "fine.nc"] + mill, [])
    yield ("include", ["caller.nc", "subs/O2000.nc"], ["caller.nc", "-m", "mill.toml", "--include", "subs"],
           {"-o": "out.nc", "--summary": "sum.json"}, ["subs/O2000.nc"], [])
    yield ("dialect", ["part.nc", "own.toml"], ["part.nc", "-m", "mill.toml", "-d", "./own.toml"],
           {"-o": "out.nc", "--summary": "sum.json"}, ["own.toml"], [])
    yield ("map", [], ["map", "-m", "mill.toml", "--grid", "3x3x3"],
           {"--csv": "m.csv", "--json": "m.json", "--html": "m.html", "--vtk": "m.vtk"}, mill, [])
    yield ("budget", ["points.csv"], ["budget", "-m", "mill.toml", "--points", "points.csv"], {"--json": "b.json"}, ["points.csv"] + mill, [])
    yield ("diagnose", ["rows.csv", "hold.csv", "backlash.toml"],
           ["diagnose", "rows.csv", "-m", "backlash.toml", "--holdout", "hold.csv"],
           {"--json": "d.json", "--html": "d.html", "--write-profile": "d.toml"}, ["rows.csv", "hold.csv", "backlash.toml"],
           [("--write-profile", "backlash.toml")])
    yield ("calibrate", ["volume.csv"], ["calibrate", "volumetric", "volume.csv", "--name", "N", "--chain", "[w X Y b Z t]"],
           {"-o": "c.toml"}, ["volume.csv"], [])
    yield ("batch", ["part.nc"], ["batch", "part.nc", "-m", "mill.toml", "-O", "outs"], {"--results": "r.jsonl"}, ["part.nc"] + mill, [])
    yield ("plan", ["part.nc"], ["batch", "plan", "part.nc", "-m", "mill.toml", "-O", "outs"], {"--manifest": "p.jsonl"}, ["part.nc"] + mill, [])
    yield ("run", ["part.nc", "plan.jsonl"], ["batch", "run", "--manifest", "plan.jsonl"], {"--results": "r.jsonl"},
           ["part.nc", "plan.jsonl"] + mill, [])


def stock(judge):
    """One folder with every file the scenes need."""
    folder = judge.folder("stock")
    mill = profile(folder)
    text = program(random.Random(3), 40)
    write(os.path.join(folder, "part.nc"), text)
    write(os.path.join(folder, "caller.nc"), text.replace(b"G0 Z50.\nM30", b"M98 P2000\nG0 Z50.\nM30"))
    write(os.path.join(folder, "subs", "O2000.nc"), b"O2000\nG1 X60. Y60.\nM99\n")
    shutil.copy(os.path.join(REPOSITORY, "grammars", "fanuc.toml"), os.path.join(folder, "own.toml"))
    judge.run([os.path.join(folder, "part.nc"), "-m", mill, "-o", os.path.join(folder, "fine.nc")])
    write(os.path.join(folder, "points.csv"), "x_mm,y_mm,z_mm\n10,10,10\n50,60,70\n200,100,90\n")
    for name, to in (("backlash.csv", "rows.csv"), ("backlash_holdout.csv", "hold.csv"), ("backlash.toml", "backlash.toml")):
        shutil.copy(os.path.join(SAMPLES, "diagnosis", name), os.path.join(folder, to))
    shutil.copy(os.path.join(SAMPLES, "calibration", "volume_points.csv"), os.path.join(folder, "volume.csv"))
    judge.run(["batch", "plan", "part.nc", "-m", "mill.toml", "-O", "outs", "--manifest", "plan.jsonl"], cwd=folder)
    return folder


def fresh(judge, stocked):
    folder = os.path.join(judge.work, "slip")
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(stocked, folder, symlinks=True)
    return folder


def pairs(judge, stocked):
    for name, needs, args, outputs, inputs, allowed in scenes():
        folder = fresh(judge, stocked)
        plain = judge.run(args + [w for o, n in outputs.items() for w in (o, n)], cwd=folder)
        if not judge.judge("scenes stand", plain.status not in (0,) or not all(os.path.exists(os.path.join(folder, n)) for n in outputs.values()),
                           name, "exit status %d, %s" % (plain.status, first_line(plain.err)), "exit status 0 and all outputs", args):
            continue
        for option in outputs:
            for victim in inputs:
                for how, _ in list(spellings(fresh(judge, stocked), victim)):
                    folder = fresh(judge, stocked)
                    place = dict(spellings(folder, victim))[how]
                    before = tree(folder)
                    command = args + [option, place]
                    ended = judge.run(command, cwd=folder)
                    after = tree(folder)
                    lost = sorted(n for n in before if after.get(n) != before[n])
                    case = "%s %s onto %s (%s)" % (name, option, victim, how)
                    if (option, victim) in allowed:
                        if option == "-o" and ended.status == 0:
                            whole = after.get(victim, b"") == read(os.path.join(stocked, "fine.nc")) or how == "hard link"
                            odd = not whole or set(lost) - {victim, "hard"}
                        else:
                            odd = (ended.status != 0 and lost) or set(lost) - {victim, "hard", "soft"}
                        judge.judge("output onto an input, allowed", odd or broke_down(ended), case,
                                    "exit status %d, changed: %s" % (ended.status, lost), "the whole new file, or refused", command)
                        continue
                    judge.judge("output onto an input", ended.status == 0 or lost or broke_down(ended), case,
                                "exit status %d, changed: %s" % (ended.status, lost), "refused, every file as it was", command)
        for first in outputs:
            for second in outputs:
                if first >= second:
                    continue
                for exists in (False, True):
                    probe = fresh(judge, stocked)
                    if exists:
                        write(os.path.join(probe, "same"), "OLD\n")
                    for how, _ in list(spellings(probe, "same")):
                        folder = fresh(judge, stocked)
                        if exists:
                            write(os.path.join(folder, "same"), "OLD\n")
                        place = dict(spellings(folder, "same"))[how]
                        before = tree(folder)
                        command = args + [first, "same", second, place]
                        ended = judge.run(command, cwd=folder)
                        after = tree(folder)
                        judge.judge("two outputs in one place", ended.status == 0 or after != before or broke_down(ended),
                                    "%s %s and %s in one place (%s%s)" % (name, first, second, how, ", there before" if exists else ""),
                                    "exit status %d, changed: %s" % (ended.status, sorted(n for n in after if after[n] != before.get(n))),
                                    "refused, nothing written", command)


def links_and_modes(judge, stocked):
    want = read(os.path.join(stocked, "fine.nc"))
    name = "-o through a link, into devices"

    def asked(case, make, target, kept, output="link.nc", option="-o", expect=None):
        folder = fresh(judge, stocked)
        make(folder)
        args = ["part.nc", "-m", "mill.toml", option, output]
        ended = judge.run(args, cwd=folder, timeout=20)
        got = read(os.path.join(folder, target)) if target else None
        is_kept = kept(folder)
        right = (got == want) if expect is None else expect(got, ended)
        judge.judge(name, not right or not is_kept or (expect is None and ended.status != 0) or broke_down(ended) or ended.timed_out, case,
                    "exit status %d, target %s, link or device %s" % (ended.status, "written" if got == want else "not written",
                    "kept" if is_kept else "replaced"), "the link's target written, the link kept", args)

    def link(to, existing=True, folder_too=None):
        def make(folder):
            if folder_too:
                os.makedirs(os.path.join(folder, folder_too), exist_ok=True)
            os.symlink(to, os.path.join(folder, "link.nc"))
            if existing:
                write(os.path.join(folder, to), "OLD\n")
        return make

    def is_link(folder):
        return os.path.islink(os.path.join(folder, "link.nc"))
    asked("link to a file", link("target.nc"), "target.nc", is_link)
    asked("link into another folder", link("far/target.nc", folder_too="far"), "far/target.nc", is_link)
    asked("link to nothing yet", link("target.nc", existing=False), "target.nc", is_link)
    asked("link to a link", lambda f: (os.symlink("second", os.path.join(f, "link.nc")), os.symlink("target.nc", os.path.join(f, "second")),
                                       write(os.path.join(f, "target.nc"), "OLD\n")), "target.nc",
          lambda f: is_link(f) and os.path.islink(os.path.join(f, "second")))
    asked("link that leads to itself", lambda f: os.symlink("link.nc", os.path.join(f, "link.nc")), None, is_link,
          expect=lambda got, ended: ended.status != 0)
    asked("a folder", lambda f: os.mkdir(os.path.join(f, "link.nc")), None, lambda f: os.path.isdir(os.path.join(f, "link.nc")),
          expect=lambda got, ended: ended.status != 0)
    if os.geteuid() == 0:
        for option in ("-o", "--summary"):
            asked("%s onto a character device" % option, lambda f: os.mknod(os.path.join(f, "link.nc"), stat.S_IFCHR | 0o666, os.makedev(1, 3)), None,
                  lambda f: stat.S_ISCHR(os.lstat(os.path.join(f, "link.nc")).st_mode), option=option, expect=lambda got, ended: True)
        asked("-o onto a device that is full", lambda f: os.mknod(os.path.join(f, "link.nc"), stat.S_IFCHR | 0o666, os.makedev(1, 7)), None,
              lambda f: stat.S_ISCHR(os.lstat(os.path.join(f, "link.nc")).st_mode), expect=lambda got, ended: ended.status != 0)
    else:
        judge.note("device nodes SKIPPED: not root")
    name_mode = "mode of what was there kept"
    for option, output in (("-o", "out.nc"), ("--summary", "sum.json")):
        for mode in (0o664, 0o600, 0o640, 0o755, 0o444, None):
            for umask in (0o022, 0o077, 0o002):
                folder = fresh(judge, stocked)
                place = os.path.join(folder, output)
                if mode is not None:
                    write(place, "OLD\n")
                    os.chmod(place, mode)
                args = ["part.nc", "-m", "mill.toml", option, output]
                ended = judge.run(args, cwd=folder, umask=umask)
                got = stat.S_IMODE(os.stat(place).st_mode) if os.path.exists(place) else None
                expected = mode if mode is not None else 0o666 & ~umask
                judge.judge(name_mode, got != expected or (ended.status != 0 and mode != 0o444), "%s, mode %s, umask %03o"
                            % (option, "%04o" % mode if mode is not None else "none before", umask),
                            "exit status %d, mode %s" % (ended.status, None if got is None else "%04o" % got), "mode %04o" % expected, args)
    folder = fresh(judge, stocked)
    args = ["batch", "part.nc", "-m", "mill.toml", "-O", "outs"]
    judge.run(args, cwd=folder)
    os.chmod(os.path.join(folder, "outs", "part.nc"), 0o664)
    ended = judge.run(args + ["--force"], cwd=folder)
    got = stat.S_IMODE(os.stat(os.path.join(folder, "outs", "part.nc")).st_mode)
    judge.judge(name_mode, got != 0o664, "batch --force over its own output of mode 0664", "exit status %d, mode %04o" % (ended.status, got),
                "mode 0664", args)


def standard_output(judge, stocked):
    name = "closed, full or broken standard output"
    folder = fresh(judge, stocked)
    write(os.path.join(folder, "long.nc"), program(random.Random(4), 20000))
    commands = [["part.nc", "-m", "mill.toml"], ["long.nc", "-m", "mill.toml"], ["check", "part.nc", "fine.nc", "-m", "mill.toml"],
                ["check", "part.nc", "fine.nc", "-m", "mill.toml", "--json"], ["predict", "points.csv", "-m", "mill.toml"],
                ["solve", "points.csv", "-m", "mill.toml"], ["map", "-m", "mill.toml", "--grid", "3x3x3"],
                ["budget", "-m", "mill.toml", "--grid", "3x3x3"], ["diagnose", "rows.csv", "-m", "backlash.toml"],
                ["calibrate", "volumetric", "volume.csv", "--name", "N", "--chain", "[w X Y b Z t]"],
                ["profile", "check", "mill.toml"], ["profile", "show", "mill.toml"], ["profile", "schema"], ["grammar", "list"],
                ["grammar", "check", "own.toml"], ["man"], ["completions", "bash"], ["batch", "part.nc", "-m", "mill.toml", "-O", "o2"],
                ["batch", "part.nc", "-m", "mill.toml", "-O", "o3", "--results", "-"], ["--help"], ["--version"]]
    for args in commands:
        plain = judge.run(args, cwd=folder)
        if not plain.out:
            continue
        for how in ("closed", "full", "broken pipe"):
            shutil.rmtree(os.path.join(folder, "o2"), ignore_errors=True)
            shutil.rmtree(os.path.join(folder, "o3"), ignore_errors=True)
            if how == "closed":
                ended = judge.run(args, cwd=folder, before=lambda: os.close(1))
            elif how == "full":
                with open("/dev/full", "wb") as full:
                    ended = judge.run(args, cwd=folder, stdout=full)
            else:
                reader, writer = os.pipe()
                os.close(reader)
                ended = judge.run(args, cwd=folder, stdout=writer)
                os.close(writer)
            fine = ended.status in (1, 2, 75, 141, -signal.SIGPIPE) and not broke_down(ended)
            if args[0].startswith("--") and how == "broken pipe":
                fine = not broke_down(ended)        # `--help | head`: every tool keeps quiet about that
            judge.judge(name + (" (help, version)" if args[0].startswith("--") else ""), not fine, "%s: %s" % (" ".join(args[:3]), how),
                        "exit status %d%s" % (ended.status, ", broke down: " + first_line(ended.err) if broke_down(ended) else ""),
                        "not exit status 0, no panic", args)
    args = ["part.nc", "-m", "mill.toml", "-o", "nostderr.nc"]
    ended = judge.run(args, cwd=folder, before=lambda: (os.close(2), os.close(0)))
    judge.judge(name, ended.status != 0 or read(os.path.join(folder, "nostderr.nc")) != read(os.path.join(folder, "fine.nc")),
                "standard input and error closed", "exit status %d" % ended.status, "exit status 0 and the output", args)


def leftovers(judge, stocked):
    """Runs killed without warning; what the next run leaves in TMPDIR and beside the output."""
    name = "leftovers of killed runs swept by the next"
    folder = fresh(judge, stocked)
    big = program(random.Random(6), 400000)          # more than 16 MiB: what is held back goes to the disk
    temporary = os.path.join(folder, "tmp")
    os.makedirs(temporary)
    os.makedirs(os.path.join(folder, "res"))
    env = judge.environment(TMPDIR=temporary)
    for case, args, piped in (("pipe to standard output", ["-", "-m", "mill.toml"], True), ("pipe to -o", ["-", "-m", "mill.toml", "-o", "res/out.nc"], True),
                              ("file to -o", ["big.nc", "-m", "mill.toml", "-o", "res/out.nc", "--summary", "res/s.json"], False),
                              ("file to standard output", ["big.nc", "-m", "mill.toml"], False)):
        write(os.path.join(folder, "big.nc"), big)
        for share in (0.15, 0.5, 0.85):
            child = judge.start(args, cwd=folder, stdin=subprocess.PIPE if piped else None, stdout=subprocess.PIPE, env=env)
            if piped:
                try:
                    child.stdin.write(big[:int(len(big) * share)])
                    child.stdin.flush()
                except BrokenPipeError:
                    pass
            time.sleep(0.3 if piped else share * 1.5)
            held = sorted(os.listdir(temporary) + os.listdir(os.path.join(folder, "res")))
            child.kill()
            child.wait()
            child.stdout.close()
            if piped:
                try:
                    child.stdin.close()
                except BrokenPipeError:
                    pass
            small = read(os.path.join(folder, "part.nc"))
            other = [a if a not in ("big.nc",) else "part.nc" for a in args]
            ended = judge.run(other, cwd=folder, data=small if piped else None, env=env)
            left = sorted(os.listdir(temporary) + [n for n in os.listdir(os.path.join(folder, "res")) if n not in ("out.nc", "s.json")])
            judge.judge(name, left or ended.status != 0, "%s, killed at %d %%" % (case, 100 * share),
                        "left: %s (there when killed: %s); next run: exit status %d" % (left, held, ended.status),
                        "nothing left behind the next run", args)
            for path in left:
                os.remove(os.path.join(temporary, path)) if os.path.exists(os.path.join(temporary, path)) else None
    # The copy of a run that still lives is not swept.
    child = judge.start(["-", "-m", "mill.toml"], cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=env)
    part = read(os.path.join(folder, "part.nc"))
    child.stdin.write(part[:300])
    child.stdin.flush()
    time.sleep(0.3)
    judge.run(["-", "-m", "mill.toml"], cwd=folder, data=part, env=env)
    out, _ = child.communicate(part[300:])
    judge.judge(name, child.returncode != 0 or out != read(os.path.join(folder, "fine.nc")), "a run that lives beside the one that sweeps",
                "exit status %d, output %s" % (child.returncode, "right" if out == read(os.path.join(folder, "fine.nc")) else "wrong"),
                "its copy stays", ["-", "-m", "mill.toml"])


def run(judge):
    stocked = stock(judge)
    pairs(judge, stocked)
    links_and_modes(judge, stocked)
    standard_output(judge, stocked)
    leftovers(judge, stocked)
