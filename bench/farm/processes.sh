#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Farms of real processes on this machine: how long a job takes on two workers of one core each against one, what
# share of the processor's time the coordinator has, and what lies between submitting a small job and its image.
# usage: bench/farm/processes.sh BUILD_FOLDER [SCENE [PAIRS [SAMPLES]]]     SCENE: another one besides those of scenes/
set -euo pipefail
cd "$(dirname "$0")/../.."
tessera=$PWD/$1/cli/tessera latency=$PWD/$1/bench/farm/latency_bench
scene=${2:-} pairs=${3:-3} samples=${4:-64}
work=$(mktemp -d)
started=()
end() { for pid in "${started[@]}"; do kill "$pid" 2>/dev/null || true; done; wait; rm -rf "$work"; }
trap end EXIT

# A coordinator; its process is $coordinator.
farm() {
  "$tessera" coordinator --listen "ipc://$work/$1" --store "$work/$1.store" 2>"$work/$1.log" & coordinator=$!
  started+=($coordinator)
}
# worker FARM NAME CORES THREADS
worker() {
  taskset -c "$3" "$tessera" worker --coordinator "ipc://$work/$1" --name "$2" --threads "$4" --cache "$work/$2" \
    2>"$work/$2.log" &
  started+=($!)
}
# Seconds of processor time that the processes have had.
spent() {
  local sum=0 pid
  for pid in "$@"; do sum=$((sum + $(awk '{ print $14 + $15 }' "/proc/$pid/stat"))); done
  awk -v n=$sum -v hz="$(getconf CLK_TCK)" 'BEGIN { print n / hz }'
}
steal() { awk '/^cpu / { print $9 }' /proc/stat; }
# The frame's seconds, as its farm counts them: of the job on the farm.
job() {
  local farm=$1 name=$2
  shift 2
  TESSERA_COORDINATOR=ipc://$work/$farm "$tessera" submit --job "$name" --quiet --wait "$@" >/dev/null
  TESSERA_COORDINATOR=ipc://$work/$farm "$tessera" jobs --json "$name" |
    sed -n 's/^      "seconds": \([0-9.]*\),*$/\1/p' | head -1
}

# scaling TITLE JOB_OPTIONS...
scaling() {
  local title=$1 i
  shift
  job one "warm-$RANDOM$RANDOM" "$@" >/dev/null
  job two "warm-$RANDOM$RANDOM" "$@" >/dev/null
  printf '%s\n%8s %8s %7s   %-14s %-14s %s\n' "$title" '1, s' '2, s' ratio 'cores of 1' 'cores of 2' 'coordinator'
  for i in $(seq "$pairs"); do
    local a0 a1 b0 b1 c0 c1 t1 t2
    a0=$(spent "${one[@]}") t1=$(job one "$i-$RANDOM$RANDOM" "$@") a1=$(spent "${one[@]}")
    b0=$(spent "${two[@]}") c0=$(spent "$two_centre") t2=$(job two "$i-$RANDOM$RANDOM" "$@")
    b1=$(spent "${two[@]}") c1=$(spent "$two_centre")
    awk -v t1="$t1" -v t2="$t2" -v a=$a0 -v A="$a1" -v b="$b0" -v B="$b1" -v c="$c0" -v C="$c1" 'BEGIN {
      printf "%8.2f %8.2f %7.3f   %-14.2f %-14.2f %.2f %%\n", t1, t2, t1 / t2, (A - a) / t1, (B - b) / t2,
             100 * (C - c) / (B - b + C - c) }'
  done
}

echo "load $(cut -d' ' -f1-3 /proc/loadavg), steal so far $(steal) ticks"
farm one; worker one alone 0 1; one=("${started[-1]}")
farm two; two_centre=$coordinator; worker two left 0 1; two=("${started[-1]}"); worker two right 1 1; two+=("${started[-1]}")
scaling "cornell, 60 tiles of 128x128, $samples samples; goals: ratio 1.9, coordinator at most 2 %" \
  scenes/cornell.json --width 1280 --height 768 --tile-size 128 --samples "$samples"
if [ -n "$scene" ]; then
  scaling "$(basename "$scene"), 960x540, $samples samples" "$scene" --width 960 --height 540 --samples "$samples"
else
  echo 'no other scene: name one to have it measured'
fi

farm small; worker small both 0,1 2
for samples in 8 64; do
  echo "latency, cornell, 256x256, $samples samples, a warm farm:"
  TESSERA_COORDINATOR=ipc://$work/small "$latency" 9 "$work" scenes/cornell.json --width 256 --height 256 \
    --samples $samples | grep -v '^latency'
done
begin=$(date +%s%N)
for i in 1 2 3 4 5; do "$tessera" --version >/dev/null; done
echo "starting a process, mean of 5: $((($(date +%s%N) - begin) / 5000000)) ms"
echo "load $(cut -d' ' -f1-3 /proc/loadavg), steal $(steal) ticks"
