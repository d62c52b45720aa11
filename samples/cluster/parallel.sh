#!/bin/bash
# The shards of a manifest with GNU parallel (Debian: parallel), on the machines of a list:
#
#   vpost batch plan release -m machine.toml -O corrected --manifest plan.jsonl
#   parallel.sh plan.jsonl 16 --sshloginfile machines.txt --workdir .
#
# The same command again runs only the shards that failed or were not reached: parallel keeps a list of them beside the
# manifest. Without machines it runs on this one.
set -euo pipefail

manifest=$1
shards=$2
shift 2

# One shard at a time on a machine: it uses all cores.
seq "$shards" | parallel --jobs 1 --joblog "$manifest.joblog" --resume-failed --retries 3 "$@" \
  vpost batch run --quiet --manifest "$manifest" --shard "{}/$shards"
