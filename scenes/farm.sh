#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A farm on this machine: a coordinator and two workers that render the demo scene; all of it ends with this script.
# Writes to the folder OUT, or to out.
# usage: scenes/farm.sh BUILD_FOLDER [options of tessera submit]
set -euo pipefail
cd "$(dirname "$0")/.."
tessera=$1/cli/tessera
generate=$1/scenes/tessera_generate
shift
out=${OUT:-out}
mkdir -p "$out"

# A socket's path may have about 100 letters, so it is not in the project's folder.
farm=$(mktemp -d "${TMPDIR:-/tmp}/tessera-farm.XXXXXX")
export TESSERA_COORDINATOR=ipc://$farm/socket
processes=()

# The last first, so that workers can say that they leave. A session of its own each: Ctrl-C is for this script alone.
stop() {
  trap - EXIT INT TERM
  for ((i = ${#processes[@]} - 1; i >= 0; --i)); do
    kill "${processes[i]}" 2>/dev/null || true
    wait "${processes[i]}" 2>/dev/null || true
  done
  rm -rf "$farm"
}
trap stop EXIT
trap 'exit 130' INT TERM

start() {
  local log=$out/farm_$1.log
  shift
  setsid "$tessera" "$@" >"$log" 2>&1 &
  processes+=($!)
}

start coordinator coordinator --listen "$TESSERA_COORDINATOR" --store "$farm/store"
threads=$((($(nproc) + 1) / 2))
for name in one two; do
  start "$name" worker --name "$name" --threads "$threads" --cache "$farm/cache_$name"
done
echo "farm: a coordinator and two workers; they write $out/farm_coordinator.log, farm_one.log and farm_two.log"

"$generate" "$out/demo_scene"
echo "farm: hands in $out/demo_scene/courtyard.json; Ctrl-C ends it all"
"$tessera" submit "$out/demo_scene/courtyard.json" --name courtyard --until relmse=0.006 -o "$out/farm.exr" "$@" &
processes+=($!)
code=0
wait $! || code=$?

if [ "$code" -eq 0 ] || [ "$code" -eq 8 ]; then
  "$tessera" jobs --all
  "$tessera" workers
  echo "farm: the image is $out/farm.exr, its preview $out/farm.png"
else
  tail -n 3 "$out"/farm_{coordinator,one,two}.log >&2
fi
exit "$code"
