#!/usr/bin/env bash
# Measures the tables of docs/performance.md and writes that page.
#
# usage: bench/measure.sh BUILD [OUT [PART]...]
#
# BUILD is a build folder of the package (scripts/bench.sh makes one: .ws/build). The tables go to OUT
# (default: docs/data/performance), the page to docs/performance.md. Without PARTs all are measured;
# parts that are not measured stay as they are in OUT:
#   motion        errors and cost in motion, beside Bullet (eight minutes; to docs/data/study)
#   hang, sphere  cloth_sim beside Bullet, at rest at the end (ten minutes each)
#   parts         kernels, parts of a step, surgery and messages (eight minutes)
#   turns         floors and whole scenes, in turns with what they are compared with (three minutes)
#   steps         steps of every method (ten minutes; without the sizes that take minutes per step,
#                 which `cloth_bench --benchmark_filter=^step/` includes)
#   threads       speed-up by a second thread (two minutes)
#   scale         memory of large cloths (a minute)
#   node          cost of the node beside its steps (two minutes; source its devel space first)
# Nothing else should run. Write one line about the machine to OUT/machine.txt first.
set -euo pipefail

case ${1:-} in
  -h | --help | '') sed -n '2,18p' "$0" | sed 's/^# \{0,1\}//' && exit $(($# == 0 ? 2 : 0)) ;;
esac
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$1
out=${2:-$root/docs/data/performance}
parts=("${@:3}")
[[ ${#parts[@]} -gt 0 ]] || parts=(motion hang sphere parts turns steps threads scale node)
mkdir -p "$out"
[[ -s $out/machine.txt ]] ||
  { echo "error: $out/machine.txt: missing, expected a line on the machine" >&2; exit 2; }
find_program() {
  find "$build" "$build/../devel" -type f -name "$1" -print -quit 2> /dev/null || true
}
peer=$(find_program peer_bullet)
bench=$(find_program cloth_bench)
[[ -x $peer && -x $bench ]] ||
  { echo "error: $build: no peer_bullet or cloth_bench (make peer_bullet cloth_bench)" >&2; exit 2; }

# run_bench FILE CORE|all FILTER: five repetitions of the benchmarks that match FILTER.
run_bench() {
  local pinned=()
  [[ $2 == all ]] || pinned=(taskset -c "$2")
  "${pinned[@]}" "$bench" --benchmark_filter="$3" --benchmark_repetitions=5 \
    --benchmark_min_time=0.05 --benchmark_report_aggregates_only=true --benchmark_format=json \
    > "$1.part" 2> /dev/null
  mv "$1.part" "$1"
}

for part in "${parts[@]}"; do
  case $part in
    motion) taskset -c 0 "$peer" --motion "$root/docs/data/study/peer_motion.csv" > /dev/null ;;
    hang | sphere) taskset -c 0 "$peer" --scenes "$part" --json "$out/$part.json" ;;
    parts) run_bench "$out/parts.json" 0 '^(kernel|part|surgery|message|sleep)/' ;;
    turns) run_bench "$out/turns.json" 0 '^(floor|whole)/' ;;
    steps) run_bench "$out/steps.json" all \
      '^step/((xpbd|projective)/threads:./side:(32|128)|(xpbd|pbd)/threads:1/side:[0-9]*|projective/threads:1/side:256|[a-z0-9_]*/threads:1/side:(32|64|128))/' ;;
    threads) run_bench "$out/threads.json" all '^threads/' ;;
    scale) run_bench "$out/scale.json" 0 '^scale/.*/xpbd/' ;;
    node) "$root/bench/node_overhead" "$out/node.json" > /dev/null ;;
    *) echo "error: unknown part '$part' (motion, hang, sphere, parts, turns, steps, threads, scale, node)" >&2 && exit 2 ;;
  esac
done
/usr/bin/python3 "$root/bench/report.py" "$out" > "$out/page.part"
cat "$out/page.part" > "$root/docs/performance.md"
rm "$out/page.part"
echo "$root/docs/performance.md"
