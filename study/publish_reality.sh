#!/bin/bash
# Publishes the comparison with theory and measured cloth: measures it, if DIR has no tables yet, and
# writes its tables, its charts and docs/reality.md. It takes a quarter of an hour on two quiet cores.
#
# usage: study/publish_reality.sh DIR   (a folder for the tables; in it, reality_machine.txt may say in
#                                       one line where they were measured)
set -euo pipefail
folder=${1:?usage: study/publish_reality.sh DIR}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
data=$root/docs/data/study
if [ ! -e "$folder/reality_swing.csv" ]; then
  cloth_study --parts reality --jobs "${JOBS:-2}" --no-charts --out "$folder"
fi
if [ ! -s "$folder/reality_machine.txt" ]; then
  lscpu | sed -n 's/^Model name: *//p' | head -n 1 > "$folder/reality_machine.txt"
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$folder"/reality_*.csv "$folder/reality_machine.txt" "$work"

# The page first: if one of its claims is no longer so, nothing is published.
/usr/bin/python3 "$root/study/report.py" "$root/study/reality.md.in" "$work" > "$work/page"
/usr/bin/python3 "$root/study/plots.py" "$work"
for chart in bending drape pull fling tear; do
  cp "$work/reality_$chart.png" "$root/docs/images/"
done
cp "$work"/reality_*.csv "$work/reality_machine.txt" "$data/"
cat "$work/page" > "$root/docs/reality.md"
echo "$root/docs/reality.md"
