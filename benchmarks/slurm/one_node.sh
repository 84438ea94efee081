#!/bin/sh
# A cluster of one node, this machine: munged, slurmctld and slurmd without systemd, root's cgroups or a database.
#
#   apt-get install slurm-wlm munge
#   benchmarks/slurm/one_node.sh up         start it, or find it running
#   . /tmp/hybridid-slurm/environment       then sbatch, squeue and hybridid launcher=slurm reach it
#   benchmarks/slurm/one_node.sh down       end it
#
# Everything lies in $HYBRIDID_SLURM (default: /tmp/hybridid-slurm); /etc is not touched. Works as root in a
# container, and as a user for that user's own jobs.
set -eu

S=${HYBRIDID_SLURM:-/tmp/hybridid-slurm}
HOST=$(hostname -s)
USER_NAME=$(id -un)
CTLD_PORT=${HYBRIDID_SLURM_PORT:-46817}
NODE_PORT=$((CTLD_PORT + 1))
export SLURM_CONF="$S/slurm.conf"
PATH=$PATH:/usr/sbin:/sbin

fail() {
    echo "one_node.sh: $*" >&2
    exit 1
}

running() { # NAME: whether its process lives
    [ -s "$S/$1.pid" ] && kill -0 "$(cat "$S/$1.pid")" 2>/dev/null
}

configure() {
    # munged refuses folders that others may write to
    umask 022
    mkdir -p "$S/state" "$S/spool"
    [ -s "$S/munge.key" ] || (umask 077 && dd if=/dev/urandom of="$S/munge.key" bs=128 count=1 2>/dev/null)
    memory=$(awk '/^MemTotal/ { print int($2 / 1024 * 0.9) }' /proc/meminfo)
    cat >"$SLURM_CONF" <<EOF
ClusterName=hybridid
SlurmctldHost=$HOST(127.0.0.1)
SlurmctldPort=$CTLD_PORT
SlurmdPort=$NODE_PORT
SlurmUser=$USER_NAME
SlurmdUser=$USER_NAME
AuthType=auth/munge
AuthInfo=socket=$S/munge.socket
StateSaveLocation=$S/state
SlurmdSpoolDir=$S/spool
SlurmctldPidFile=$S/slurmctld.pid
SlurmdPidFile=$S/slurmd.pid
SlurmctldLogFile=$S/slurmctld.log
SlurmdLogFile=$S/slurmd.log
# a container has no cgroups to give away
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MaxArraySize=10001
SchedulerParameters=sched_interval=2,sched_min_interval=100000
NodeName=$HOST NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$memory State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
EOF
    # newer Slurms ask for a cgroup plugin even so, unless told; older ones do not know the word
    case $(slurmd -V) in
    "slurm 2"[3-9].*) echo "CgroupPlugin=disabled" >"$S/cgroup.conf" ;;
    esac
    echo "export SLURM_CONF=$SLURM_CONF" >"$S/environment"
}

up() {
    for program in munged slurmctld slurmd sbatch; do
        command -v $program >/dev/null || fail "$program is missing: apt-get install slurm-wlm munge"
    done
    configure
    running munged || munged --key-file="$S/munge.key" --socket="$S/munge.socket" --pid-file="$S/munged.pid" \
        --log-file="$S/munged.log" --seed-file="$S/munged.seed"
    running slurmctld || slurmctld -f "$SLURM_CONF"
    running slurmd || slurmd -f "$SLURM_CONF" -N "$HOST"
    tries=0
    until [ "$(sinfo --noheader --format=%T 2>/dev/null)" = idle ] || sinfo -h -o %T | grep -qE 'mixed|allocated'; do
        tries=$((tries + 1))
        [ $tries -lt 60 ] || fail "the node does not come up; see $S/slurmctld.log and $S/slurmd.log"
        sleep 0.5
    done
    sinfo
    echo "for this shell: . $S/environment"
}

down() {
    for name in slurmd slurmctld munged; do
        running $name || continue
        kill "$(cat "$S/$name.pid")"
        tries=0
        while running $name && [ $tries -lt 40 ]; do
            tries=$((tries + 1))
            sleep 0.25
        done
        ! running $name || fail "$name does not end; its process is $(cat "$S/$name.pid")"
    done
    echo "down; its files stay in $S"
}

case ${1:-} in
up) up ;;
down) down ;;
*) fail "say up or down" ;;
esac
