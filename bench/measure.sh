#!/usr/bin/env bash
# Measures everything that docs/performance.md tells, and writes that page.
#
# usage: bench/measure.sh BUILD [OUT]
#
# BUILD is a build folder of the package (scripts/bench.sh makes one: .ws/build). The tables go to OUT
# (default: docs/data/performance), the page to docs/performance.md. A quarter of an hour on one core;
# nothing else should run. The line in OUT/machine.txt says what machine it was: write it first.
set -euo pipefail

case ${1:-} in
  -h | --help | '') sed -n '2,8p' "$0" | sed 's/^# \{0,1\}//' && exit $(($# == 0 ? 2 : 0)) ;;
esac
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$1
out=${2:-$root/docs/data/performance}
mkdir -p "$out"
[[ -s $out/machine.txt ]] ||
  { echo "error: $out/machine.txt: missing, expected a line on the machine" >&2; exit 2; }
find_program() {
  find "$build" "$build/../devel" -type f -name "$1" 2> /dev/null | head -n 1
}
peer=$(find_program peer_bullet)
bench=$(find_program cloth_bench)
[[ -x $peer && -x $bench ]] ||
  { echo "error: $build: no peer_bullet or cloth_bench (make peer_bullet cloth_bench)" >&2; exit 2; }

taskset -c 0 "$peer" --json "$out/peer.json"
taskset -c 0 "$bench" --benchmark_filter='^(kernel|part|floor)/' --benchmark_repetitions=5 \
  --benchmark_min_time=0.1 --benchmark_report_aggregates_only=true --benchmark_format=json \
  > "$out/parts.json" 2> /dev/null
# The larger sizes of the slower methods take minutes a step.
"$bench" --benchmark_filter='^step/.*/side:(32|64|128|256)/' --benchmark_repetitions=5 \
  --benchmark_min_time=0.05 --benchmark_report_aggregates_only=true --benchmark_format=json \
  > "$out/steps.json" 2> /dev/null
"$bench" --benchmark_filter='^step/(xpbd|verlet)/.*/side:(512|1024)/' --benchmark_repetitions=3 \
  --benchmark_min_time=0.05 --benchmark_report_aggregates_only=true --benchmark_format=json \
  > "$out/large.json" 2> /dev/null
/usr/bin/python3 "$root/bench/report.py" "$out" > "$root/docs/performance.md"
echo "$root/docs/performance.md"
