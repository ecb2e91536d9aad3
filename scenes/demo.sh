#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Renders the demo scene until the denoised image is good enough and says how good it truly is.
# usage: scenes/demo.sh BUILD_FOLDER [options of tessera render]
set -euo pipefail
cd "$(dirname "$0")/.."
tessera=$1/cli/tessera
generate=$1/scenes/tessera_generate
shift
mkdir -p out

"$generate" out/demo_scene
echo "demo: rendering until every part of the image has a relative error (relMSE) of at most 0.006"
code=0
"$tessera" render out/demo_scene/courtyard.json -o out/demo.exr --until relmse=0.006 "$@" || code=$?
if [ "$code" -ne 0 ] && [ "$code" -ne 8 ]; then exit "$code"; fi

if [ $# -eq 0 ]; then  # the reference is of the demo as it stands
  echo "demo: against a reference of 1024 samples per pixel without a filter:"
  "$tessera" compare out/demo.exr scenes/demo_reference.exr --sheet out/demo_comparison.png --heat-map out/demo_error.png
  echo "demo: out/demo_comparison.png shows noisy | denoised | reference; out/demo_error.png where the error is"
fi
echo "demo: the image is out/demo.exr, its preview out/demo.png"
exit "$code"
