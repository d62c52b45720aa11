"""Three HyperQueue workers run the shards of a manifest; one of them is killed in the middle of its task.

    python hyperqueue_loses_a_worker.py VPOST MANIFEST SHARDS OUTPUT

Prints what happened as JSON; the caller compares the outputs.
"""

import json
import os
import pathlib
import signal
import sys
import tempfile
import time

from hyperqueue.cluster import LocalCluster, WorkerConfig

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "samples" / "cluster"))
import on_hyperqueue  # noqa: E402


def worker(cluster):
    """A worker in a process of its own, so that it can be killed. Workers of a LocalCluster are threads otherwise."""
    process = os.fork()
    if process == 0:
        cluster.start_worker(WorkerConfig(cores=1))
        while True:
            time.sleep(1)
    return process


def children(process):
    """Processes that a process started, from any of its threads."""
    found = []
    for path in pathlib.Path(f"/proc/{process}/task").glob("*/children"):
        found += [int(word) for word in path.read_text().split()]
    return found


def main():
    vpost, manifest, shards, output = sys.argv[1:]
    output = pathlib.Path(output)
    with tempfile.TemporaryDirectory() as folder:
        cluster = LocalCluster(os.path.join(folder, "server"))
        workers = [worker(cluster) for _ in range(3)]
        try:
            client = cluster.client()
            job = on_hyperqueue.submit(client, manifest, int(shards), vpost)
            # The first worker that is seen with a task, once some output stands.
            victim, tasks = None, []
            deadline = time.monotonic() + 120
            while victim is None and time.monotonic() < deadline:
                if any(output.rglob("*.nc")):
                    # Asked once: a task may end while its worker is looked at again.
                    seen = ((one, children(one)) for one in workers)
                    victim, tasks = next(((one, found) for one, found in seen if found), (None, []))
                time.sleep(0.002)
            if victim:
                # The machine is gone: its tasks with it.
                for process in [victim, *tasks]:
                    try:
                        os.kill(process, signal.SIGKILL)
                    except ProcessLookupError:
                        pass
                os.waitpid(victim, 0)
            stood = len(list(output.rglob("*.nc")))
            done = client.wait_for_jobs([job], raise_on_error=False)
        finally:
            for process in workers:
                try:
                    os.kill(process, signal.SIGKILL)
                except ProcessLookupError:
                    pass
            cluster.stop()
    print(json.dumps({"killed": victim is not None, "tasks": len(tasks), "stood": stood, "done": done}))


main()
