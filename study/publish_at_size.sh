#!/bin/bash
# Publishes the errors at size: the table, its charts and docs/at_size.md.
#
# usage: study/publish_at_size.sh DIR   (DIR: of cloth_study --parts at_size --out, and in it
#                                       at_size_machine.txt: one line, where it was measured)
#
# Bullet's points come from docs/data/study/peer_motion.csv (bench/measure.sh BUILD '' motion).
set -euo pipefail
folder=${1:?usage: study/publish_at_size.sh DIR}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
data=$root/docs/data/study
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$folder/at_size.csv" "$folder/at_size_machine.txt" "$data/peer_motion.csv" "$work"

# The page first: if one of its claims is no longer so, nothing is published.
/usr/bin/python3 "$root/study/report.py" "$root/study/at_size.md.in" "$work" > "$work/page"
/usr/bin/python3 "$root/study/plots.py" "$work"
cp "$work"/at_size_*.png "$root/docs/images/"
for name in at_size.csv at_size_machine.txt; do cp "$work/$name" "$data/$name"; done
cat "$work/page" > "$root/docs/at_size.md"
echo "$root/docs/at_size.md"
