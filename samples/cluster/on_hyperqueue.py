"""The shards of a manifest as tasks of HyperQueue (`pip install hyperqueue`).

    vpost batch plan release -m machine.toml -O corrected --manifest plan.jsonl
    python on_hyperqueue.py plan.jsonl 16                        a cluster of its own on this machine
    python on_hyperqueue.py plan.jsonl 16 --server-dir DIR       a HyperQueue server that runs already

A task whose worker dies is started again on another worker. Ends with 0 if all tasks ended well; `vpost batch merge` says
what is missing.
"""

import argparse
import os
import sys

from hyperqueue import Client, Job
from hyperqueue.cluster import LocalCluster, WorkerConfig


def submit(client, manifest, shards, vpost="vpost"):
    """Submits a task for each shard. Tasks that fail do not stop the others."""
    job = Job(default_workdir=os.getcwd(), max_fails=None, name="vpost")
    # Tasks of the Python interface count from 0, so each is told its shard. With `hq submit --array 1-16` it is
    # `--shard auto/16`.
    for number in range(1, shards + 1):
        job.program(
            [vpost, "batch", "run", "--quiet", "--manifest", manifest, "--shard", f"{number}/{shards}"],
            stdout=f"{manifest}.{number}.stdout",
            stderr=f"{manifest}.{number}.stderr",
        )
    return client.submit(job)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("manifest")
    arguments.add_argument("shards", type=int)
    arguments.add_argument("--server-dir")
    given = arguments.parse_args()
    if given.server_dir:
        client = Client(given.server_dir)
        done = client.wait_for_jobs([submit(client, given.manifest, given.shards)], raise_on_error=False)
    else:
        with LocalCluster() as cluster:
            # One task at a time: a shard uses all cores.
            cluster.start_worker(WorkerConfig(cores=1))
            client = cluster.client()
            done = client.wait_for_jobs([submit(client, given.manifest, given.shards)], raise_on_error=False)
    return 0 if done else 1


if __name__ == "__main__":
    sys.exit(main())
