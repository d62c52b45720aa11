"""Power cut: an ext4 image on a loop device is copied while the command is stopped; the copy is the disk after the cut.

What a write puts into the mounted file system's page cache is not in the backing file, so a copy of the backing file holds what the
disk held. The file system is mounted so that nothing is done for the careless: data=writeback (names may be durable before data),
noauto_da_alloc (no writing of data upon a rename over an old file), delayed allocation. Of each stopped moment two disks are kept:

  asis    the backing file as it stands;
  commit  after an fsync of an unrelated file, which commits the journal: every name given so far is durable, and of the data only
          what the command itself asked for. Any other program on the computer may bring that about at any moment.

On each disk: every final name holds what it held before or the whole new bytes; the same command again ends with exit status 0 and the
bytes of a run that nothing disturbed. A run that had ended with exit status 0 must have everything under its final name.

In every other run strace holds up each fsync, rename and link before and after, so that moments fall between them as often as within work.
"""

import os
import random
import re
import shutil
import signal
import subprocess
import time

from runner import first_line, profile, program, read, stop, tree, words, write

CALLS = "fsync,fdatasync,sync,syncfs,rename,renameat,renameat2,link,linkat,unlink,unlinkat,ftruncate"
OPTIONS = "loop,data=writeback,noauto_da_alloc,nodiscard"


def quiet(*args):
    return subprocess.run(args, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)


class Disk:
    """One mount point, always the same, so that the same command means the same on every disk."""

    def __init__(self, folder):
        self.mount_point = os.path.join(folder, "disk")
        os.makedirs(self.mount_point, exist_ok=True)
        self.mounted = False

    def mount(self, image, commit=5):
        done = quiet("mount", "-o", "%s,commit=%d" % (OPTIONS, commit), image, self.mount_point)
        if done.returncode != 0:
            raise OSError(done.stdout.decode("utf-8", "replace"))
        self.mounted = True

    def unmount(self):
        for _ in range(100):
            if not self.mounted or quiet("umount", self.mount_point).returncode == 0:
                self.mounted = False
                return
            time.sleep(0.05)
        quiet("umount", "-l", self.mount_point)
        self.mounted = False


def make_image(path, megabytes):
    with open(path, "wb") as out:
        out.truncate(megabytes << 20)
    done = quiet("mke2fs", "-q", "-F", "-t", "ext4", "-E", "lazy_itable_init=0,lazy_journal_init=0", path)
    if done.returncode != 0:
        raise OSError(done.stdout.decode("utf-8", "replace"))


def copy(image, to):
    subprocess.run(["cp", "--sparse=always", image, to], check=True)


def possible(judge):
    """None where cuts can be simulated here, else why not."""
    if os.geteuid() != 0:
        return "not root"
    folder = judge.folder("probe")
    disk = Disk(folder)
    try:
        make_image(os.path.join(folder, "image"), 16)
        disk.mount(os.path.join(folder, "image"))
    except (OSError, FileNotFoundError) as error:
        return "no loop device can be mounted: %s" % error
    finally:
        disk.unmount()
        shutil.rmtree(folder, ignore_errors=True)
    return None


class Scene:
    """A command whose outputs lie on the disk, with what they were before and what they are when nothing disturbs it."""

    def __init__(self, judge, check, name, folder, megabytes, prepare, args, finals, reports=(), in_place=False):
        self.judge, self.check, self.name, self.args = judge, check, name, args
        self.finals, self.reports, self.in_place = finals, reports, in_place
        self.folder = folder
        self.disk = Disk(folder)
        self.slow_seconds = None
        self.base = os.path.join(folder, name + ".base")
        make_image(self.base, megabytes)
        self.disk.mount(self.base)
        try:
            prepare(self.disk.mount_point)
            self.old = {n: read(self.place(n)) for n in list(finals) + list(reports)}
        finally:
            self.disk.unmount()
        image = os.path.join(folder, "reference")
        copy(self.base, image)
        self.disk.mount(image)
        begin = time.monotonic()
        ended = judge.run(args, cwd=folder, env=self.environment(), timeout=300)
        self.seconds = time.monotonic() - begin
        self.new = {n: read(self.place(n)) for n in list(finals) + list(reports)}
        self.disk.unmount()
        if in_place and ended.status in (1, 2) and self.new == self.old:
            judge.note("power cut, in place: `-o` onto the program is refused, so there is nothing to cut")
            self.ready = False
            return
        self.ready = ended.status == 0 and all(self.new[n] for n in finals) and any(self.new[n] != self.old[n] for n in finals)
        if not self.ready:
            judge.fail(check, name, "the undisturbed run: exit status %s, %d of %d names new; %s"
                       % (ended.status, sum(self.new[n] != self.old[n] for n in finals), len(finals), first_line(ended.err)),
                       "exit status 0 and new outputs under their names%s" % (" (through the link)" if name == "link" else ""), args)

    def place(self, name):
        return os.path.join(self.disk.mount_point, name)

    def environment(self):
        return self.judge.environment(TMPDIR=os.path.join(self.disk.mount_point, "tmp"))

    def under(self):
        """How a run is slowed down between its calls, and how long it then takes (found by one run)."""
        if shutil.which("strace") is None:
            self.judge.note("calls cannot be held up in power cuts: no strace")
            return (), self.seconds
        delay = 1500 if len(self.finals) > 1 else 25000
        under = ["strace", "-f", "-qq", "-o", "/dev/null", "-e", "trace=" + CALLS, "-e", "inject=%s:delay_enter=%d:delay_exit=%d" % (CALLS, delay, delay)]
        if self.slow_seconds is None:
            live = os.path.join(self.folder, "live")
            copy(self.base, live)
            self.disk.mount(live)
            begin = time.monotonic()
            self.judge.start(self.args, cwd=self.folder, env=self.environment(), under=under).wait()
            self.slow_seconds = time.monotonic() - begin
            self.disk.unmount()
        return under, self.slow_seconds

    def cut(self, rng, at_end=False, slow=False):
        """One run, stopped once at a random moment (or looked at right after its end), and the disks of that moment. True where it still ran."""
        under, seconds = self.under() if slow else ((), self.seconds)
        live = os.path.join(self.folder, "live")
        copy(self.base, live)
        self.disk.mount(live, commit=rng.choice([1, 5, 300]))
        begin = time.monotonic()
        child = self.judge.start(self.args, cwd=self.folder, env=self.environment(), under=under)
        moment = rng.uniform(0, seconds)
        disks = []
        try:
            while (at_end or time.monotonic() < begin + moment) and child.poll() is None:
                time.sleep(0.0005)
            running = stop(child)
            if running and under:
                time.sleep(0.02)        # the command itself stands at its next call
            ended = None if running else child.wait()
            if not running and not at_end and not under:
                self.seconds = min(self.seconds, time.monotonic() - begin)
            disks.append(("asis", os.path.join(self.folder, "cut.asis")))
            copy(live, disks[0][1])
            with open(self.place("unrelated"), "wb") as out:
                out.write(b"x")
                out.flush()
                os.fsync(out.fileno())
            disks.append(("commit", os.path.join(self.folder, "cut.commit")))
            copy(live, disks[1][1])
        finally:
            if child.poll() is None:
                for pid in children(child.pid) + [child.pid]:
                    try:
                        os.kill(pid, signal.SIGKILL)
                    except ProcessLookupError:
                        pass
                child.wait()
            self.disk.unmount()
            os.remove(live)
        when = "%.0f ms of %.0f%s" % (1000 * moment, 1000 * seconds, ", calls held up" if slow else "")
        if ended is not None:
            when = "after its end with exit status %d" % ended
        for kind, image in disks:
            self.examine(kind, image, when, finished=ended == 0)
            os.remove(image)
        return ended is None

    def examine(self, kind, image, when, finished):
        case = "%s, cut %s, disk %s" % (self.name, when, kind)
        durable = self.check + ", durable after exit 0"
        self.disk.mount(image)
        try:
            torn, lost, torn_reports, lost_reports = [], [], [], []
            at_cut = {}
            for names, bad, gone in ((self.finals, torn, lost), (self.reports, torn_reports, lost_reports)):
                for name in names:
                    at_cut[name] = found = read(self.place(name))
                    if found not in (self.old[name], self.new[name]):
                        bad.append("%s %s" % (name, looks(found)))
                    elif finished and found != self.new[name]:
                        gone.append("%s %s" % (name, "absent" if found is None else "still old"))
            held = ["%s: %s" % (n, looks(f)) for n, f in sorted(at_cut.items())]
            kept = (("names-at-the-cut.txt", "\n".join(held).encode()),)
            self.judge.judge(self.check + ", old or whole new", torn, case, "%d of %d names: %s" % (len(torn), len(self.finals), torn[:2]),
                             "every final name holds the old or the whole new bytes", self.args, kept)
            if self.reports:
                self.judge.judge(self.check + ", reports old or whole new", torn_reports, case, torn_reports[:3], "old or whole new",
                                 self.args, kept)
            if finished:
                self.judge.judge(durable, lost or torn, case, "%d of %d names: %s" % (len(lost + torn), len(self.finals), (lost + torn)[:2]),
                                 "all new outputs are on the disk under their names", self.args, kept)
                if self.reports:
                    self.judge.judge(durable + " (reports)", lost_reports or torn_reports, case, (lost_reports + torn_reports)[:3],
                                     "the report is on the disk under its name", self.args, kept)
            ended = self.judge.run(self.args, cwd=self.folder, env=self.environment(), timeout=300)
            after = {n: read(self.place(n)) for n in self.finals}
            differ = [n for n in self.finals if after[n] != self.new[n]]
            fine = ended.status == 0
            if self.in_place and all(at_cut[n] == self.new[n] for n in self.finals):
                fine = ended.status in (0, 1)       # the input had been replaced: correcting it again is refused, and nothing changes
            self.judge.judge(self.check + ", same command completes", not fine or differ, case,
                             "exit status %d, %d of %d outputs not those of an undisturbed run (%s); %s"
                             % (ended.status, len(differ), len(self.finals), differ[:2], ended.err[:200].decode("utf-8", "replace")),
                             "exit status 0 and the same bytes", self.args, kept + (("messages.txt", ended.err),))
            if fine:
                strays = [n for n in tree(self.disk.mount_point) if n not in self.finals and n not in self.reports
                          and not re.match(r"(lost\+found|unrelated$|programs/|link\.nc$|out/\.vpost/(lock|journal/[^/]*)$)", n)]
                self.judge.judge(self.check + ", nothing lies about", strays, case, "left behind: %s" % strays[:4],
                                 "leftovers of the cut run are swept by the next", self.args)
        finally:
            self.disk.unmount()


def children(pid):
    """The processes that a process started, and theirs."""
    found = []
    try:
        for task in os.listdir("/proc/%d/task" % pid):
            with open("/proc/%d/task/%s/children" % (pid, task)) as src:
                for child in map(int, src.read().split()):
                    found += [child] + children(child)
    except (FileNotFoundError, ProcessLookupError):
        pass
    return found


def looks(found):
    if found is None:
        return "absent"
    if not found:
        return "empty"
    if not found.strip(b"\0"):
        return "%d NUL bytes" % len(found)
    return "%d bytes%s" % (len(found), ", with NUL bytes" if b"\0" in found else "")


def batch_scene(judge, folder, rng, how):
    programs = os.path.join(folder, "programs-" + how)
    os.makedirs(programs)
    new = profile(folder, "new.toml", "120.0")
    old = profile(folder, "old.toml", "-60.0")
    names = []
    later = []
    for number in range(240):
        name = "op%d/p%03d.nc" % (number % 3, number)
        blocks = rng.choice([1, 3, 10, 40, 40, 200, 200, 900, 3000])
        data = (name, program(rng, blocks))
        names.append(name)
        if number % 3 == 1:
            later.append(data)
        else:
            write(os.path.join(programs, name), data[1])
    write(os.path.join(programs, "op0/no_motion.nc"), b"%\nO9\n(NOTHING MOVES)\nM30\n%\n")
    names.append("op0/no_motion.nc")
    disk = os.path.join(folder, "disk")
    out = os.path.join(disk, "out")
    results = os.path.join(folder, "results.jsonl")

    def prepare(mount_point):
        os.makedirs(os.path.join(mount_point, "tmp"))
        judge.run(["batch", programs, "-m", old, "-O", out, "-q"], cwd=folder, timeout=300)
        for name, data in later:
            write(os.path.join(programs, name), data)
        if how == "shard":
            judge.run(["batch", "plan", programs, "-m", new, "-O", out, "--manifest", os.path.join(folder, "plan.jsonl")], cwd=folder)
    args = ["batch", programs, "-m", new, "-O", out, "-q", "--results", results]
    if how == "shard":
        args = ["batch", "run", "--manifest", os.path.join(folder, "plan.jsonl"), "-q"]
    return Scene(judge, "power cut in batch", how, folder, 96, prepare, args, ["out/" + n for n in names])


def single_scene(judge, folder, rng, how):
    mill = profile(folder, "new.toml", "120.0")
    text = program(rng, 6000)
    given = write(os.path.join(folder, how + ".nc"), text)
    disk = os.path.join(folder, "disk")
    target = "out.nc"

    def prepare(mount_point):
        os.makedirs(os.path.join(mount_point, "tmp"))
        if how in ("old", "link", "old and summary"):
            write(os.path.join(mount_point, "out.nc"), program(random.Random(5), 5000))
        if how == "link":
            os.symlink("out.nc", os.path.join(mount_point, "link.nc"))
        if how == "in place":
            write(os.path.join(mount_point, "out.nc"), text)
    output = os.path.join(disk, "link.nc" if how == "link" else target)
    args = [output if how == "in place" else given, "-m", mill, "-o", output]
    reports = []
    if "summary" in how:
        args += ["--summary", os.path.join(disk, "summary.json")]
        reports = ["summary.json"]
    return Scene(judge, "power cut in single runs", how, folder, 24, prepare, args, [target], reports, in_place=how == "in place")


def damaged_journal(judge, folder, rng):
    """What older versions or other file systems leave: outputs emptied or full of NUL bytes, the journal cut, with NULs, gone."""
    name = "outputs and journal damaged by a cut"
    folder = judge.folder("damaged")
    mill = profile(folder)
    for number in range(12):
        write(os.path.join(folder, "in", "p%02d.nc" % number), program(rng, 30 + number))
    write(os.path.join(folder, "in", "still.nc"), b"%\nO9\n(NOTHING MOVES)\nM30\n%\n")
    args = ["batch", "in", "-m", mill, "-O", "out", "-q", "--results", "results.jsonl"]
    judge.run(args, cwd=folder)
    whole = tree(os.path.join(folder, "out"))
    results = read(os.path.join(folder, "results.jsonl"))
    finals = [n for n in whole if not n.startswith(".vpost")]
    journals = [n for n in whole if n.startswith(".vpost/") and whole[n] and not n.endswith("lock")]
    if not judge.judge(name, len(finals) != 13 or not journals, "undisturbed", "%d outputs, notebook %s" % (len(finals), journals),
                       "13 outputs and a notebook", args):
        return

    def spoil(path, how):
        data = read(path)
        cut = rng.randrange(1, len(data))
        spoilt = {"empty": b"", "NUL": b"\0" * len(data), "cut": data[:cut], "NUL tail": data[:cut] + b"\0" * (len(data) - cut),
                  "NUL page": data[:cut] + b"\0" * min(4096, len(data) - cut) + data[cut + 4096:],
                  "NUL added": data + b"\0" * 4096, "garbage": os.urandom(200)}[how]
        write(path, spoilt)
    cases = [("outputs " + h, finals, h) for h in ("empty", "NUL")]
    cases += [("three outputs " + h, finals[2:5], h) for h in ("empty", "NUL")]
    cases += [("notebook " + h, journals, h) for h in ("empty", "NUL", "cut", "NUL tail", "NUL page", "NUL added", "garbage")]
    cases += [("notebook cut, outputs empty", None, "both"), ("notebook gone", None, "gone")]
    older = name + ", notebook cut as well"
    for case, paths, how in cases:
        shutil.rmtree(os.path.join(folder, "out"))
        for key, data in whole.items():
            write(os.path.join(folder, "out", key), data)
        if how == "gone":
            shutil.rmtree(os.path.join(folder, "out", ".vpost"))
        elif how == "both":
            for path in journals:
                spoil(os.path.join(folder, "out", path), "cut")
            for path in finals[:5]:
                spoil(os.path.join(folder, "out", path), "empty")
        else:
            for path in paths:
                spoil(os.path.join(folder, "out", path), how)
        state = tree(os.path.join(folder, "out"))
        ended = judge.run(args, cwd=folder)
        after = tree(os.path.join(folder, "out"))
        differ = [n for n in finals if after.get(n) != whole[n]]
        same_results = read(os.path.join(folder, "results.jsonl")) == results
        judge.judge(older if how == "both" else name, ended.status != 0 or differ or not same_results, case,
                    "exit status %d, %d of %d outputs wrong (%s), results %s; %s" % (ended.status, len(differ), len(finals), differ[:2],
                    "same" if same_results else "differ", ended.err[:160].decode("utf-8", "replace")),
                    "exit status 0 and the same bytes", "vpost " + words(args),
                    [("before-" + k.replace("/", "_"), v) for k, v in list(state.items())[:20]])


def run(judge):
    rng = random.Random(judge.seed)
    folder = judge.folder("cut")
    damaged_journal(judge, folder, rng)
    why = possible(judge)
    if why is not None:
        judge.note("power cuts SKIPPED: %s" % why)
        return
    plan = [("batch", "whole", 24), ("batch", "shard", 6), ("single", "old", 7), ("single", "absent", 4), ("single", "link", 3),
            ("single", "in place", 3), ("single", "old and summary", 3)]
    for kind, how, share in plan:
        cuts = max(1, round(share * judge.count / 50))
        scene_folder = judge.folder("cut")
        scene = (batch_scene if kind == "batch" else single_scene)(judge, scene_folder, rng, how)
        try:
            if scene.ready:
                scene.cut(rng, at_end=True)
                running = tries = 0
                while running < cuts and tries < 3 * cuts:      # cuts that find the command at work are those that count
                    running += scene.cut(rng, slow=tries % 2 == 1)
                    tries += 1
                judge.note("power cut, %s: %d cuts of a running command, %d after its end" % (how, running, tries - running + 1))
        finally:
            scene.disk.unmount()
            shutil.rmtree(scene_folder, ignore_errors=True)
