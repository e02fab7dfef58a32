#!/bin/sh
# Enters pinwarp into the desktop's menu, with its icon and its files, for this user alone.
#   ./install.sh            leave the program in this folder, and enter it
#   ./install.sh --remove   take the entries away
set -eu
here=$(cd "$(dirname "$0")" && pwd)
data=${XDG_DATA_HOME:-$HOME/.local/share}
icon=$data/icons/hicolor/scalable/apps/pinwarp.svg
mime=$data/mime/packages/pinwarp.xml
entry=$data/applications/pinwarp.desktop
command=$HOME/.local/bin/pinwarp

if [ "${1:-}" = --remove ]; then
  rm -f "$icon" "$mime" "$entry"
  # A pinwarp that somebody else put there stays.
  [ "$(readlink "$command" || true)" = "$here/pinwarp" ] && rm -f "$command"
else
  mkdir -p "$(dirname "$icon")" "$(dirname "$mime")" "$(dirname "$entry")" "$(dirname "$command")"
  cp "$here/pinwarp.svg" "$icon"
  cp "$here/pinwarp-mime.xml" "$mime"
  # Inside quotation marks an entry wants its own signs escaped, and that for the file once more.
  place=$(printf '%s' "$here/pinwarp" | sed 's/[\\"`$]/\\\\&/g; s/%/%%/g')
  awk -v line="Exec=\"$(printf '%s' "$place" | sed 's/\\/\\\\/g')\" %f" \
    '/^Exec=/ { print line; next } { print }' "$here/pinwarp.desktop" > "$entry"
  [ -e "$command" ] || ln -sf "$here/pinwarp" "$command"
fi
# Without these a desktop notices by itself, later.
command -v update-mime-database >/dev/null && update-mime-database "$data/mime" || true
command -v update-desktop-database >/dev/null && update-desktop-database "$data/applications" || true
[ "${1:-}" = --remove ] && echo "pinwarp is out of the menu." || echo "pinwarp is in the menu."
