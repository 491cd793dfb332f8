#!/bin/sh
# Builds every net in this folder from its plain sources, or only those named:
#     sumo_nets/build.sh [NAME ...]
# Each folder's NAME.netccfg lists the sources and the options of netconvert. The comment with date and versions is
# cut out of the net, so that building again gives the same bytes.
set -eu
here=$(cd "$(dirname "$0")" && pwd)

if [ -x "$here/../.venv/bin/netconvert" ]; then
    netconvert=$here/../.venv/bin/netconvert
elif command -v netconvert >/dev/null 2>&1; then
    netconvert=netconvert
else
    echo "build.sh: netconvert not found, neither in .venv/bin nor on PATH (pip install eclipse-sumo)" >&2
    exit 2
fi

[ $# -gt 0 ] || set -- $(cd "$here" && ls -d */ | tr -d /)
for name in "$@"; do
    for config in "$here/$name"/*.netccfg; do
        [ -e "$config" ] || continue # the folder runs another one's net
        net=${config%.netccfg}.net.xml
        (cd "$here/$name" && "$netconvert" -c "$config" -o "$net" >/dev/null)
        sed '/^<!-- generated on/,/-->$/d' "$net" >"$net.tmp"
        mv "$net.tmp" "$net"
        echo "$net"
    done
done
