#!/usr/bin/env bash
# Makes a film and a sweep by examples/cluster/slurm.sh on Slurm, with one controller and two nodes on this machine. While
# they make chunks of the film, one node is drained, one fails, and two tasks are killed. Fails unless film and sweep have
# the bytes of one machine.
# Usage: slurm.sh BUILD
# BUILD is a folder of Corda with the tests. Takes root. The processes have a namespace, with which they end, and a network.
set -euo pipefail
build=$(realpath "${1:?usage: slurm.sh BUILD}")
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
if [[ $$ -ne 1 ]]; then
    "$root/src/cmake/setup.sh" cluster
    work=$(mktemp -d --tmpdir corda-slurm.XXXXXX)
    trap 'rm -rf --one-file-system "$work"' EXIT
    unshare --pid --fork --kill-child --mount-proc --net "$0" "$build" "$work"
    exit
fi
work=$2
ip link set lo up
ip address add 10.0.0.1/32 dev lo  # with 127.0.0.1 alone, getaddrinfo() finds no name
mkdir "$work"/{state,spool,shared}
export SLURM_CONF=$work/slurm.conf RUNS=$work/runs PATH=$root/tests/cluster:$PATH
export CORDA_PROGRAM=$build/corda FOREIGN_FAULTS=$build/tests/libforeign_faults.so HELD_SHARDS="0/4 1/4 2/4 3/4"

# Requeued tasks wait until the credentials of their first run expire.
cat >"$SLURM_CONF" <<END
ClusterName=corda
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmUser=root
AuthInfo=socket=$work/munge.socket,cred_expire=5
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool/%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/%n.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SlurmdParameters=config_overrides
MailProg=/bin/true
NodeName=node[1-2] NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=[17001-17002] CPUs=1
PartitionName=all Nodes=ALL Default=YES
END
echo CgroupPlugin=cgroup/v1 >"$work/cgroup.conf"
(umask 077 && head -c 1024 /dev/urandom >"$work/munge.key")
munged --foreground --force --socket "$work/munge.socket" --key-file "$work/munge.key" --pid-file "$work/munge.pid" \
    --log-file "$work/munge.log" --seed-file "$work/munge.seed" 2>"$work/munge.err" &

# wait_for COMMAND...: until it succeeds.
wait_for() {
    local last=$((SECONDS + 60))
    until "$@" 2>/dev/null; do
        if [[ $SECONDS -ge $last ]]; then
            echo "slurm.sh: waited in vain for: $*" >&2
            tail -n 20 "$work"/*.log "$work"/shared/slurm-* "$RUNS" >&2
            exit 1
        fi
        sleep 0.05
    done
}

wait_for test -S "$work/munge.socket"
slurmctld -D 2>/dev/null &
for node in node1 node2; do slurmd -D -N $node 2>/dev/null & done
are_idle() { [[ $(sinfo --noheader --format %D --states idle) == 2 ]]; }
wait_for are_idle

# field N SHARD: of the last run of a shard, 1: its process, 2: its node.
field() { grep -e "--shard $2/4\$" "$RUNS" | tail -n 1 | cut -d ' ' -f "$1"; }
has_chunk() { compgen -G "swing.mp4.parts/00000$1-*" >/dev/null; }  # the first chunk of shard $1 is on the disk
is_in_state() { scontrol show job --oneliner "$1" | grep -q "JobState=$2 "; }

# submit COMMAND...: makes four shards, then joins them; sets the numbers of both jobs.
submit() {
    array=$(sbatch --parsable --array=0-3 "$root/examples/cluster/slurm.sh" "$@")
    join=$(sbatch --parsable --dependency="afterany:$array" "$root/examples/cluster/slurm.sh" "$@")
}

cd "$work/shared"
cp "$root"/tests/cluster/*.toml .
"$CORDA_PROGRAM" render swing.toml -o alone.mp4 -q
"$CORDA_PROGRAM" sweep sweep.toml -o alone -q

submit corda render swing.toml -o swing.mp4
wait_for has_chunk 0
wait_for has_chunk 1
drained=$(field 2 1)
scontrol update nodename="$drained" state=drain reason=test  # task 1 runs to its end; no other begins here
touch "$RUNS-release-1"
kill -9 "$(field 1 0)"
wait_for is_in_state "${array}_0" FAILED
scontrol requeue "${array}_0"
wait_for has_chunk 2
lost=$(field 2 2)
scontrol update nodename="$lost" state=down reason=test  # Slurm requeues task 2
wait_for is_in_state "${array}_2" PENDING
scontrol update nodename="$lost" state=resume
wait_for has_chunk 3
kill -9 "$(field 1 3)"  # the joining job makes its other chunks
wait_for is_in_state "${array}_3" FAILED
wait_for is_in_state "$join" COMPLETED

cmp swing.mp4 alone.mp4
for line in "0/4 2" "1/4 1" "2/4 2" "3/4 1"; do
    count=$(grep -c -e "--shard ${line% *}\$" "$RUNS")
    [[ $count == "${line#* }" ]] || { echo "slurm.sh: shard ${line% *} was run $count times:"; cat "$RUNS"; exit 1; }
done
[[ $(grep -c " $drained " "$RUNS") == 1 ]] || { echo "slurm.sh: $drained was drained and was given tasks:"; cat "$RUNS"; exit 1; }

scontrol update nodename="$drained" state=resume
submit corda sweep sweep.toml -o clips
wait_for is_in_state "$join" COMPLETED
diff -r clips alone
echo "slurm.sh: $(scontrol --version), $(munged --version | head -1): the bytes of one machine by these runs (process, node, arguments):"
cat "$RUNS"
