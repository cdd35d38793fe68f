#!/usr/bin/env bash
# device_window.sh VIEWER: opens the viewer on a display of its own and uses it as a user would: resize, drag, wheel, both
# renderers, hide and show, close. Validation must stay silent (the viewer exits 1 otherwise) and the screen must show a
# picture. Exit 77: skipped, for lack of Xvfb or xdotool.
set -euo pipefail
viewer=$1
for tool in Xvfb xdotool; do
    command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed"; exit 77; }
done

work=$(mktemp -d)
server=
program=
finish() {
    [ -z "$program" ] || kill "$program" 2>/dev/null || true
    [ -z "$server" ] || kill "$server" 2>/dev/null || true
    wait 2>/dev/null || true
    rm -rf "$work"
}
trap finish EXIT
fail() {
    echo "FAILED: $*"
    cat "$work/log" 2>/dev/null || true
    exit 1
}
# until_true SECONDS COMMAND...: tries until it succeeds.
until_true() {
    local tries=$(($1 * 10))
    shift
    while ! "$@"; do
        tries=$((tries - 1))
        [ $tries -gt 0 ] || return 1
        sleep 0.1
    done
}

if env -u DISPLAY -u WAYLAND_DISPLAY "$viewer" builtin:cornell 2>"$work/log"; then fail "a window without a display"; fi
grep -q "there is no display" "$work/log" || fail "no word of the missing display"

# The server picks a free number, and keeps its screen in a file that can be looked at (xwd format).
Xvfb -displayfd 3 -screen 0 640x480x24 -fbdir "$work" 3>"$work/display" 2>/dev/null &
server=$!
until_true 20 test -s "$work/display" || fail "Xvfb does not start"
DISPLAY=:$(cat "$work/display")
export DISPLAY
# The pixels follow a header and a table of 256 colours: distinct ones, and a fingerprint of them all.
pixels() { tail -c $((640 * 480 * 4)) "$work/Xvfb_screen0"; }
colours() { pixels | od -An -v -t x4 -w4 | sort -u | wc -l; }
shows_a_picture() { [ "$(colours)" -ge 100 ]; }
changed_from() { [ "$(pixels | cksum)" != "$1" ]; }

"$viewer" builtin:cornell --size 640x480 --validate --screenshot "$work/last.png" 2>"$work/log" &
program=$!
title_has() { xdotool search --name "^etalon: .*$1" >/dev/null 2>&1; }
until_true 60 title_has raster || fail "no window, or no rasterized picture"
window=$(xdotool search --name "^etalon: " | tail -1)
until_true 10 shows_a_picture || fail "the rasterized picture has $(colours) colours"

before=$(pixels | cksum)
xdotool windowsize "$window" 500 400
until_true 10 changed_from "$before" || fail "a resized window shows what it did"
before=$(pixels | cksum)
xdotool windowfocus "$window" mousemove 250 200 mousedown 1 mousemove 300 220 mousemove 330 220 mouseup 1
until_true 10 changed_from "$before" || fail "a drag turns nothing"
before=$(pixels | cksum)
xdotool click 4 click 4
until_true 10 changed_from "$before" || fail "the wheel does nothing"
before=$(pixels | cksum)
xdotool mousedown 3 mousemove 300 180 mouseup 3 key f
until_true 10 changed_from "$before" || fail "F and panning do nothing"

xdotool windowfocus "$window" key p
until_true 60 title_has "path, [0-9]+ sample" || fail "P does not path trace"
until_true 10 shows_a_picture || fail "the path-traced picture has $(colours) colours"
for side in 300 411 352 479 200 333; do xdotool windowsize "$window" $side $((side - 20)); done
xdotool windowunmap "$window"
sleep 0.3
xdotool windowmap "$window"
xdotool windowsize "$window" 400 300 windowfocus "$window" key question key r
until_true 60 title_has raster || fail "R does not go back"
grep -q "left drag" "$work/log" || fail "? prints no keys"
until_true 10 shows_a_picture || fail "after all that the picture has $(colours) colours"

xdotool windowfocus "$window" key Escape
status=0
wait "$program" || status=$?
program=
[ $status -eq 0 ] || fail "exit code $status"
[ -s "$work/last.png" ] || fail "no screenshot"

timeout 60 "$viewer" builtin:cornell --size 64x64 --frames 3 --validate 2>"$work/log" || fail "--frames: exit code $?"
echo "passed"
