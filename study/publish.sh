#!/bin/bash
# Publishes a study: its tables, its charts and docs/accuracy.md.
#
# usage: study/publish.sh DIR   (DIR: of cloth_study --out, and in it machine.txt and command.txt:
#                                one line each, where and how it was measured)
set -euo pipefail
folder=${1:?usage: study/publish.sh DIR}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
for name in command.txt machine.txt; do
  [ -s "$folder/$name" ] || { echo "error: $folder/$name: missing, expected one line" >&2; exit 2; }
done

# The page first: if one of its claims is no longer so, nothing is published.
page=$(mktemp)
trap 'rm -f "$page"' EXIT
/usr/bin/python3 "$root/study/report.py" "$root/study/accuracy.md.in" "$folder" > "$page"

/usr/bin/python3 "$root/study/plots.py" "$folder"
for scene in hang_swing in_plane_wave drape_sphere table_edge seam_tear; do
  for kind in png svg; do
    cp "$folder/work_precision_$scene.$kind" "$root/docs/images/study_$scene.$kind"
  done
done
for chart in stability resolution; do
  for kind in png svg; do
    cp "$folder/$chart.$kind" "$root/docs/images/study_$chart.$kind"
  done
done
mkdir -p "$root/docs/data/study"
cp "$folder"/*.csv "$folder"/command.txt "$folder"/machine.txt "$root/docs/data/study/"
cat "$page" > "$root/docs/accuracy.md"
echo "$root/docs/accuracy.md"
