#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# fuzz/run.sh BUILD [SECONDS] [NAME ...]: runs each fuzz target for that long, as many at a time as there are processors;
# one line each; fails if one of them found something, and shows it.
set -euo pipefail
cd "$(dirname "$0")/.."
export build=$1 seconds=${2:-60}
shift $(($# < 2 ? $# : 2))
if ! [[ $seconds =~ ^[0-9]+$ ]]; then
  echo "fuzz: '$seconds' is no number of seconds" >&2
  exit 2
fi
mapfile -t names <"$build/fuzz/names"
for name; do
  if ! printf '%s\n' "${names[@]}" | grep -qxF -- "$name"; then
    echo "fuzz: there is no target '$name'; accepted: ${names[*]}" >&2
    exit 2
  fi
done
if [ $# -gt 0 ]; then names=("$@"); fi

fuzz() {
  local name=$1 work=$build/fuzz/work/$1 seed
  mkdir -p "$work/corpus" "$work/found"
  for seed in fuzz/corpus/"$name"/* tests/data/scene/*."$name"; do
    if [ -f "$seed" ]; then cp "$seed" "$work/corpus/"; fi
  done
  local dictionary=() words=fuzz/${name/glb/gltf}.dict
  if [ -f "$words" ]; then dictionary=(-dict="$words"); fi
  # Libraries forget memory when a file is broken: leaks are looked for by the tests.
  if ASAN_OPTIONS=detect_leaks=0 "$build/fuzz/fuzz_$name" -max_total_time="$seconds" -max_len=16384 \
    -rss_limit_mb=2048 -timeout=25 -print_final_stats=1 -artifact_prefix="$work/found/" "${dictionary[@]}" \
    "$work/corpus" >"$work/log" 2>&1; then
    awk -v name="$name" '/number_of_executed_units/ { runs = $2 } /peak_rss_mb/ { peak = $2 }
      END { printf "fuzz: %-8s nothing found in %d runs, at most %d MiB\n", name, runs, peak }' "$work/log"
  else
    { echo "fuzz: $name found something; the input is in $work/found"
      grep -vE '^#|NEW_FUNC' "$work/log" | tail -60; } >&2
    return 1
  fi
}
export -f fuzz

echo "fuzz: ${names[*]}; $seconds s each, $(nproc) at a time"
printf '%s\n' "${names[@]}" | xargs -P "$(nproc)" -I '{}' bash -euc 'fuzz {}'
