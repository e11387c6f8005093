#!/bin/sh
# Runs the shards of a corda command by GNU parallel, then joins them.
# Usage: parallel.sh SHARDS COMMAND...
# Several machines: PARALLEL="--sshlogin a,b --workdir $PWD" parallel.sh ...
set -eu
shards=$1
shift
export PARALLEL="--jobs 1 ${PARALLEL:-}"  # one shard at a time on each machine, which uses all of its cores
seq 0 $((shards - 1)) | parallel --quote --retries 3 "$@" --shard "{}/$shards"
"$@" --resume
