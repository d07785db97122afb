#!/usr/bin/env bash
# Compares the benchmarks of two commits by paired runs on one core.
#
# usage: bench/compare.sh [--pairs N] [--core N] COMMIT COMMIT [FILTER]
#
# Builds both commits in folders under ${TMPDIR:-/tmp} and runs their benchmarks in turn, N times each
# (default: 5). For every benchmark that both commits have, it prints the median, the smallest and the
# largest ratio of CPU times (second commit over first). FILTER is a regular expression of Google
# Benchmark (default: step/.*/threads:1/side:128).
set -euo pipefail

usage() { sed -n '2,9p' "$0" | sed 's/^# \{0,1\}//'; }
pairs=5 core=0 arguments=()
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --pairs | --core)
      [[ $# -ge 2 && $2 =~ ^[0-9]+$ ]] || { echo "error: $1 needs a number" >&2; exit 2; }
      printf -v "${1#--}" '%s' "$2"
      shift
      ;;
    -*) usage >&2 && echo "error: unknown option $1" >&2 && exit 2 ;;
    *) arguments+=("$1") ;;
  esac
  shift
done
[[ ${#arguments[@]} -ge 2 ]] || { usage >&2 && echo 'error: two commits are needed' >&2 && exit 2; }
filter=${arguments[2]:-step/.*/threads:1/side:128}

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
export PATH=/usr/bin:$PATH
names=(first second) binaries=()
for k in 0 1; do
  commit=$(git -C "$root" rev-parse --verify --quiet "${arguments[k]}^{commit}") ||
    { echo "error: ${arguments[k]}: no commit of this repository" >&2; exit 2; }
  tree=${TMPDIR:-/tmp}/cloth_bench_${commit:0:12}
  if [[ ! -d $tree ]]; then
    git -C "$root" worktree prune
    git -C "$root" worktree add --quiet --detach "$tree" "$commit"
  fi
  echo "${names[k]}: $(git -C "$root" log -1 --format='%h %s' "$commit")"
  cmake -S "$tree" -B "$tree/.bench" -DCMAKE_BUILD_TYPE=Release \
    -DPYTHON_EXECUTABLE=/usr/bin/python3 > "$tree.log" 2>&1
  make -C "$tree/.bench" -j"$(nproc)" cloth_bench >> "$tree.log" 2>&1 ||
    { echo "error: the build failed: $tree.log" >&2; exit 1; }
  binaries+=("$(find "$tree/.bench" -type f -name cloth_bench | head -n 1)")
done

results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
for ((pair = 0; pair < pairs; ++pair)); do
  for k in 0 1; do
    taskset -c "$core" "${binaries[k]}" --benchmark_filter="$filter" --benchmark_format=json \
      > "$results/${names[k]}_$pair.json" 2> /dev/null
  done
done
/usr/bin/python3 - "$results" "$pairs" << 'PYTHON'
import json
import statistics
import sys

folder, pairs = sys.argv[1], int(sys.argv[2])


def times(name, pair):
    with open('%s/%s_%d.json' % (folder, name, pair)) as file:
        return {b['name']: b['cpu_time'] for b in json.load(file)['benchmarks']}


ratios = {}
for pair in range(pairs):
    first, second = times('first', pair), times('second', pair)
    for name in first:
        if name in second:
            ratios.setdefault(name, []).append(second[name] / first[name])
if not ratios:
    sys.exit('error: no benchmark of that name in both commits')
print('%-60s %8s  [least, most]' % ('second over first, %d pairs' % pairs, 'median'))
for name, values in ratios.items():
    print('%-60s %8.3f  [%.3f, %.3f]' % (name, statistics.median(values), min(values), max(values)))
PYTHON
