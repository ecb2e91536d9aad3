#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the benchmarks of a build folder, all or those whose name contains one of the arguments.
# `quality` and `temporal` render references for the better part of an hour: only when they are asked for by name.
# usage: bench/run.sh BUILD_FOLDER [NAME ...]
set -euo pipefail
cd "$(dirname "$0")/.."
folder=$1/bench
shift
shopt -s nullglob
programs=("$folder"/*_bench "$folder"/farm/*_bench)
if [ ${#programs[@]} -eq 0 ]; then echo "bench: $folder has no benchmarks (sanitizer builds have none)" >&2; exit 1; fi
lscpu | grep -E '^(Model name|CPU\(s\)|L3)' || true
for program in "${programs[@]}"; do
  name=$(basename "$program")
  wanted=$([ $# -eq 0 ] && echo yes || echo no)
  for w in "$@"; do [[ $name == *"$w"* ]] && wanted=yes; done
  [ $# -eq 0 ] && [[ $name = quality_bench || $name = temporal_bench ]] && wanted=no
  [ "$wanted" = yes ] || continue
  printf '\n== %s\n' "$name"
  "$program"
done
