#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A farm on a real Slurm of one node, in a folder of its own: the scripts of deploy/slurm start a coordinator and
# workers, which render a picture, leave when they are cancelled, and are queued again when their time is over.
# usage: slurm_test.sh TESSERA SOURCE_FOLDER; exits with 77 if it was skipped
set -euo pipefail
export PATH=$PATH:/usr/sbin:/sbin
TESSERA=$1
source=$2
export TESSERA

skip() { echo "skipped: $*"; exit 77; }
for tool in munged slurmctld slurmd sbatch squeue scancel scontrol sinfo; do
  command -v "$tool" >/dev/null || skip "$tool is not installed (apt-get install slurm-wlm munge)"
done

work=$(mktemp -d /tmp/tessera-slurm.XXXXXX)
export SLURM_CONF=$work/slurm.conf
processes=()
stop() {
  local code=$?
  trap - EXIT
  set +e
  if [ "$code" -ne 0 ]; then tail -n 20 "$work"/*.log; fi
  scancel --user "$(id -un)" 2>/dev/null && until_true 20 no_jobs
  for ((i = ${#processes[@]} - 1; i >= 0; --i)); do kill "${processes[i]}" && wait "${processes[i]}"; done 2>/dev/null
  rm -rf "$work"
  exit "$code"
}
trap stop EXIT
trap 'exit 1' INT TERM

fail() { echo "failed: $*" >&2; exit 1; }
until_true() {  # SECONDS COMMAND ...
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    [ "$SECONDS" -lt "$end" ] || return 1
    sleep 0.2
  done
}
no_jobs() { [ -z "$(squeue --noheader)" ]; }
free_port() {
  local port
  while :; do
    port=$((20000 + RANDOM % 20000))
    (: </dev/tcp/127.0.0.1/$port) 2>/dev/null || break
  done
  echo "$port"
}

# --- Slurm ---
node=$(hostname -s)
mkdir -p "$work/state" "$work/spool" "$work/jobs"
(umask 077 && head -c 128 /dev/urandom >"$work/munge.key")
cat >"$work/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=30
NodeName=$node NodeAddr=127.0.0.1 CPUs=8 RealMemory=65536
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
munged --foreground --force --key-file="$work/munge.key" --socket="$work/munge.socket" --pid-file="$work/munge.pid" \
  --log-file="$work/munge.log" --seed-file="$work/munge.seed" >"$work/munged.log" 2>&1 &
processes+=($!)
until_true 20 test -S "$work/munge.socket" || fail "munged does not start"
slurmctld -D >"$work/slurmctld.log" 2>&1 &
processes+=($!)
slurmd -D -N "$node" >"$work/slurmd.log" 2>&1 &
processes+=($!)
node_is_idle() { [ "$(sinfo --noheader --format=%T 2>/dev/null)" = idle ]; }
until_true 60 node_is_idle || fail "the node does not come up: $(sinfo 2>&1)"

# --- The farm ---
# A worker that went without a word would stay on the list for so long.
export TESSERA_SILENCE=300 TESSERA_STORE=$work/store TESSERA_LISTEN=127.0.0.1:0 TESSERA_CACHE=$work/cache
TESSERA_PORT=$(free_port)
export TESSERA_PORT TESSERA_LISTEN=127.0.0.1:$TESSERA_PORT TESSERA_COORDINATOR=127.0.0.1:$TESSERA_PORT
cd "$work/jobs"
sbatch --parsable --output="$work/coordinator.log" "$source/deploy/slurm/tessera-coordinator.sbatch" >/dev/null
until_true 60 test -s "$work/store.address" || fail "the coordinator does not start"

workers=$(sbatch --parsable --array=1-2 --cpus-per-task=1 --time=10 --output="$work/worker-%a.log" \
  "$source/deploy/slurm/tessera-workers.sbatch")
count_workers() { "$TESSERA" workers --json 2>/dev/null | grep -c '"name": "tessera-worker-' || true; }
workers_are() { [ "$(count_workers)" = "$1" ]; }
until_true 60 workers_are 2 || fail "the workers do not come"
slots=$("$TESSERA" workers --json | sed -n 's/.*"slots": \([0-9]*\).*/\1/p' | sort -u)
[ "$slots" = 1 ] || fail "workers of one CPU have $slots slots"

"$TESSERA" submit "$source/scenes/cornell.json" --width 64 --height 64 --samples 16 -o "$work/image.exr" --quiet
[ "$(head -c 4 "$work/image.exr" | od -An -tx1 | tr -d ' ')" = 762f3101 ] || fail "there is no image"
echo "ok: a picture was rendered by two workers of an array"

# --- The time is over: it leaves and is queued again ---
scancel --batch --signal=USR1 "${workers}_1"
restarted() { scontrol show job "${workers}_1" | grep -q 'Restarts=1'; }
until_true 60 restarted || fail "the worker is not queued again: $(scontrol show job "${workers}_1")"
until_true 20 workers_are 1 || fail "the worker did not say that it leaves"
echo "ok: a worker whose time is over leaves and is queued again"

# --- Cancelled: it leaves ---
scancel "$workers"
until_true 60 workers_are 0 || fail "the cancelled worker did not say that it leaves"
if grep -h 'ends at once' "$work"/worker-*.log; then fail "a worker took too long"; fi
echo "ok: a cancelled worker leaves"

scancel --name=tessera-coordinator
until_true 60 no_jobs || fail "the coordinator does not end"
grep -q 'its jobs go on' "$work/coordinator.log" || fail "the coordinator was killed"
echo "ok: a cancelled coordinator ends"
