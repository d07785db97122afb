#!/usr/bin/env bash
source "$(dirname "${BASH_SOURCE[0]}")/lib/common.sh"

usage() {
  cat <<USAGE
usage: scripts/api_docs.sh [--out DIR]

Makes the pages of the C++ interface, include/, by Doxygen. Installs it if it is missing. A warning is
a failure.

  --out DIR   for the pages; begin with DIR/html/index.html (default: .ws/api)
  -h, --help  this text
USAGE
}

out=$repo_root/.ws/api
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --out) out=${2:?--out needs a folder} && shift ;;
    --out=*) out=${1#*=} ;;
    *) bad_usage "unknown argument '$1'" ;;
  esac
  shift
done

prepare api
mkdir -p "$out"
out=$(readlink -f "$out")
cd "$repo_root"
(cat docs/api/Doxyfile && printf 'OUTPUT_DIRECTORY = "%s"\n' "$out") | doxygen - ||
  die "Doxygen has warnings, see above"
say "$out/html/index.html"
