#!/usr/bin/env bash
# Install the programs that `make test-all` tests against: GDAL and QGIS. For Debian and its kin.
set -euo pipefail
if command -v ogrinfo >/dev/null && command -v qgis_process >/dev/null; then
    exit 0
fi
if ! command -v apt-get >/dev/null; then
    echo "GDAL and QGIS are missing; install them, or run 'make test', which does without" >&2
    exit 2
fi
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends qgis python3-qgis gdal-bin
