#!/usr/bin/env bash
# Makes a sweep and the pictures of a film by the commands of examples/cluster/README.md on Slurm, with one controller and two
# nodes on this machine. While they make pictures, a task is killed. Fails unless both have the
# bytes of one machine.
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
export PYTHONPATH=$build/python CORDA_PROGRAM=$build/corda FOREIGN_FAULTS=$build/tests/libforeign_faults.so HELD="--frames 90:180"

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

is_in_state() { scontrol show job --oneliner "$1" | grep -q "JobState=$2 "; }
# lines FIRST LAST: of the block of the page for Slurm.
lines() { sed -n '/^## Slurm/,/^## Dask/p' "$root/examples/cluster/README.md" | sed -n '/^```sh/,/^```$/p' | sed '1d;$d' | sed -n "$1,$2p"; }

cd "$work/shared"
cp "$root"/tests/cluster/*.toml .
"$CORDA_PROGRAM" render swing.toml -o alone/%06d.png -q
/usr/bin/python3 -m corda sweep sweep.toml -o alone_clips -q

job=$(eval "$(lines 3 3 | sed 's/sbatch /sbatch --parsable /')")
wait_for test -e frames/000090.png
kill -9 "$(grep -e "$HELD" "$RUNS" | cut -d ' ' -f 1)"
wait_for is_in_state "${job}_1" FAILED
scontrol requeue "${job}_1"
for i in 0 1 2 3 4 5 6 7; do wait_for is_in_state "${job}_$i" COMPLETED; done
rm -f frames/*.tmp
diff -r frames alone
[[ $(grep -c -e "$HELD" "$RUNS") == 2 ]] || { echo "slurm.sh: the killed task was not run twice:"; cat "$RUNS"; exit 1; }

export HELD=
eval "$(lines 1 2 | sed 's/sbatch --dependency/sbatch --parsable --dependency/; $s/.*/join=$(&)/')"
wait_for is_in_state "$join" COMPLETED
diff -r clips alone_clips
echo "slurm.sh: $(scontrol --version), $(munged --version | head -1): the bytes of one machine by these runs (process, node, arguments):"
cat "$RUNS"
