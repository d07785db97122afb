#!/bin/bash
# Makes docs/fabrics.md and its chart again from what cloth_run says about its fabrics.
#
# usage: study/publish_fabrics.sh   (in a shell that has sourced the workspace)
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
rosrun cloth_sim cloth_run --fabrics > "$folder/fabrics.json"
/usr/bin/python3 "$root/study/fabrics.py" page "$folder/fabrics.json" > "$folder/fabrics.md"
/usr/bin/python3 "$root/study/fabrics.py" chart "$folder/fabrics.json" "$root/docs/images"
cat "$folder/fabrics.md" > "$root/docs/fabrics.md"
echo "$root/docs/fabrics.md"
