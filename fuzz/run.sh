#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# fuzz/run.sh BUILD [SECONDS] [NAME ...]: runs each fuzz target for that long; fails if one of them found something.
set -uo pipefail
cd "$(dirname "$0")/.."
build=$1
seconds=${2:-60}
shift $(($# < 2 ? $# : 2))
if ! [[ $seconds =~ ^[0-9]+$ ]]; then
  echo "fuzz: '$seconds' is no number of seconds" >&2
  exit 2
fi
names=("$@")
if [ ${#names[@]} -eq 0 ]; then mapfile -t names <"$build/fuzz/names"; fi

found=()
for name in "${names[@]}"; do
  work=$build/fuzz/work/$name
  mkdir -p "$work/corpus" "$work/found"
  seeds=(fuzz/corpus/"$name"/* tests/data/scene/*."$name")
  for seed in "${seeds[@]}"; do [ -f "$seed" ] && cp "$seed" "$work/corpus/"; done
  dictionary=()
  if [ -f "fuzz/$name.dict" ]; then dictionary=(-dict="fuzz/$name.dict"); fi
  echo "fuzz: $name, $seconds s"
  # Libraries forget memory when a file is broken: leaks are looked for by the tests.
  if ! ASAN_OPTIONS=detect_leaks=0 "$build/fuzz/fuzz_$name" -max_total_time="$seconds" -max_len=16384 -rss_limit_mb=2048 -timeout=10 \
    -print_final_stats=1 -artifact_prefix="$work/found/" "${dictionary[@]}" "$work/corpus" \
    >"$work/log" 2>&1; then
    found+=("$name")
    grep -vE '^#|NEW_FUNC' "$work/log" | tail -60
  else
    grep -E 'number_of_executed_units|peak_rss' "$work/log"
  fi
done
if [ ${#found[@]} -gt 0 ]; then
  echo "fuzz: found something in: ${found[*]}; the inputs are in $build/fuzz/work/*/found" >&2
  exit 1
fi
