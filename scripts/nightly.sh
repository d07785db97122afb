#!/usr/bin/env bash
source "$(dirname "${BASH_SOURCE[0]}")/lib/common.sh"

usage() {
  cat <<USAGE
usage: scripts/nightly.sh [--rows a,b,...] [--resume] [--short] [--out DIR]

Runs what is too slow for every change, and prints one table; three hours on two cores. Rows:

  tests     scripts/test.sh
  address   scripts/test.sh --sanitize=address,undefined
  thread    scripts/test.sh --sanitize=thread
  fuzz      scripts/fuzz.sh, 10 minutes for each target
  soak      a node whose cloth is cut, torn, saved, loaded and reset for an hour by one client; its
            memory must stay flat to 1 % after the first fifth
  clients   two clients send a node requests and goals, good and bad, for half an hour
  tidy      scripts/lint.sh over everything

Rows that end by the clock (fuzz; soak and clients) run beside the others.

  --rows LIST   only these, separated by commas
  --resume      keeps the rows of the same commit that have ended well in the same folder, and runs
                the others
  --short       tests without a master, a minute for each target of fuzz, 5 minutes of soak and 2 of
                clients, clang-tidy for 10 minutes: to try the script
  --out DIR     for the logs (default: .ws-nightly)
  -h, --help    this text

The exit status is 0 only if every row ended well.
USAGE
}

# The rows of a line run one after the other, the lines beside each other.
readonly lines=("tests address thread tidy" "fuzz" "soak clients")
read -r -a all_rows <<<"${lines[*]}"
rows=("${all_rows[@]}")
short=no
resume=no
out=$repo_root/.ws-nightly
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --rows) IFS=, read -r -a rows <<<"${2:?--rows needs a list}" && shift ;;
    --rows=*) IFS=, read -r -a rows <<<"${1#*=}" ;;
    --short) short=yes ;;
    --resume) resume=yes ;;
    --out) out=${2:?--out needs a folder} && shift ;;
    --out=*) out=${1#*=} ;;
    *) bad_usage "unknown argument '$1'" ;;
  esac
  shift
done
for row in "${rows[@]}"; do
  [[ " ${all_rows[*]} " == *" $row "* ]] ||
    bad_usage "unknown row '$row' (known: ${all_rows[*]})"
done

# The commands of the rows; the last line of what each prints goes into the table.
quick=() fuzz_seconds=600 soak_minutes=60 client_minutes=30 tidy=()
if [[ $short == yes ]]; then
  quick=(--quick) fuzz_seconds=60 soak_minutes=5 client_minutes=2 tidy=(--minutes 10)
fi
run_row() {
  case $1 in
    tests) bash "$repo_root/scripts/test.sh" "${quick[@]}" ;;
    address) bash "$repo_root/scripts/test.sh" --sanitize=address,undefined "${quick[@]}" ;;
    thread) bash "$repo_root/scripts/test.sh" --sanitize=thread "${quick[@]}" ;;
    fuzz) bash "$repo_root/scripts/fuzz.sh" --seconds "$fuzz_seconds" ;;
    soak) drive_node soak "$soak_minutes" ;;
    clients) drive_node clients "$client_minutes" ;;
    tidy) bash "$repo_root/scripts/lint.sh" "${tidy[@]}" ;;
  esac
}

# drive_node <mode> <minutes>: a node with a master of its own on the loopback.
drive_node() {
  prepare build run
  build_workspace "$repo_root/.ws" "cloth_node" -DCMAKE_BUILD_TYPE=Release -DCLOTH_SIM_SANITIZE=
  enter_workspace "$repo_root/.ws"
  ROS_HOME=$repo_root/.ws/ros_home /usr/bin/python3 "$repo_root/scripts/lib/drive_node.py" \
    "$1" --minutes "$2"
}

# summary_of <row> <log>: the line of the table that says what the row found.
summary_of() {
  case $1 in
    fuzz) grep -E ' runs, ' "$2" | awk '{ runs += $2 } END { printf "%d runs", runs }'
      grep -q 'harm:' "$2" && printf ', harm: %s' "$(grep -c 'harm:' "$2")" ;;
    *) tail -n 1 "$2" | cut -c 1-100 ;;
  esac
}

# run_and_record <row>: leaves the line of the row in $out/<row>.result.
run_and_record() {
  local began=$SECONDS ended=well
  (run_row "$1") >"$out/$1.log" 2>&1 </dev/null || ended=BADLY
  printf '%-8s  %-6s  %7.1f  %s  %s\n' "$1" "$ended" \
    "$(awk -v s=$((SECONDS - began)) 'BEGIN { print s / 60 }')" "$(date +%F)" \
    "$(summary_of "$1" "$out/$1.log")" >"$out/$1.result"
}

ended_well() { grep -qs "^$1 *well" "$out/$1.result"; }

mkdir -p "$out"
commit=$(git -C "$repo_root" describe --always --dirty 2>/dev/null || echo no-commit-dirty)
if [[ $short == yes ]]; then commit+=', short'; fi
if [[ $resume == no || $commit == *-dirty* || $commit != "$(cat "$out/commit" 2>/dev/null)" ]]; then
  rm -f "$out"/*.result
fi
echo "$commit" >"$out/commit"
# run_line <row>...: those that are asked for and have not ended well before.
run_line() {
  local row
  for row in "$@"; do
    if [[ " ${rows[*]} " != *" $row "* ]] || ended_well "$row"; then continue; fi
    say "$row (log: $out/$row.log)"
    run_and_record "$row"
  done
}

# Ends the lines, each a process group of its own, when this script is ended.
running=()
end_lines() {
  local group
  for group in "${running[@]}"; do kill -- "-$group" 2>/dev/null || true; done
  exit 130
}
trap end_lines INT TERM
set -m
for line in "${lines[@]}"; do
  # shellcheck disable=SC2086
  run_line $line &
  running+=($!)
done
for group in "${running[@]}"; do wait "$group" || true; done
set +m
trap - INT TERM
{
  printf '%-8s  %-6s  %7s  %-10s  %s\n' row ended minutes date "found ($commit)"
  for row in "${all_rows[@]}"; do
    if [[ -f $out/$row.result ]]; then cat "$out/$row.result"; fi
  done
} >"$out/table.txt"
cat "$out/table.txt"
for row in "${rows[@]}"; do ended_well "$row" || exit 1; done
