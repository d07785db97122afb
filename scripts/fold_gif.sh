#!/usr/bin/env bash
source "$(dirname "${BASH_SOURCE[0]}")/lib/common.sh"

usage() {
  cat <<USAGE
usage: scripts/fold_gif.sh [--out GIF] [--client cpp|python]

Records the arm of fold.launch as it folds a towel, and draws the run as a GIF, without a display.
Installs missing packages and builds first.

  --out GIF      the file (default: docs/images/fold.gif)
  --client NAME  which of examples/fold moves the arm (default: cpp)
  -h, --help     this text
USAGE
}

out=$repo_root/docs/images/fold.gif
client=cpp
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --out) out=${2:?--out needs a file} && shift ;;
    --client) client=${2:?--client needs a name} && shift ;;
    *) bad_usage "unknown argument '$1'" ;;
  esac
  shift
done
out=$(readlink -f "$out")

prepare build run picture
run_timed build build_workspace "$repo_root/.ws" all
enter_workspace "$repo_root/.ws"

folder=$(mktemp -d)
launch=
cleanup() {
  if [[ -n $launch ]]; then
    kill -INT "$launch" 2>/dev/null || true
    wait "$launch" || true
  fi
  rm -rf "$folder"
}
trap cleanup EXIT

# A master of its own, so that another one on this machine is left alone.
port=$((20000 + RANDOM % 10000))
export ROS_MASTER_URI=http://localhost:$port ROSCONSOLE_STDOUT_LINE_BUFFERED=1
say "recording: $folder/fold.bag"
: >"$folder/log"
setsid roslaunch -p "$port" cloth_sim fold.launch rviz:=false client:="$client" \
  bag:="$folder/fold.bag" >"$folder/log" 2>&1 &
launch=$!
deadline=$((SECONDS + 180))
until grep -q folded "$folder/log"; do
  ((SECONDS < deadline)) || die "the towel is not folded after 180 s: $(tail -n 5 "$folder/log")"
  kill -0 "$launch" 2>/dev/null || die "roslaunch has ended: $(tail -n 5 "$folder/log")"
  sleep 0.2
done
kill -INT "$launch"
wait "$launch" || true
launch=

say "drawing: $out"
python3 "$repo_root/scripts/picture.py" "$folder/fold.bag" --video "$out" --fps 12 --size 560x420 \
  --view=-60,15 --zoom=0.45
say "$out: $(stat -c %s "$out") bytes"
