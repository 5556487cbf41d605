#!/usr/bin/env bash
# Drives a real window under a virtual display: it starts, draws, takes a key and a click, shows an error for a broken
# shader, recovers. Run by tests/window.rs inside xvfb-run, in the folder of a project made by `meniscus new dots`.
# usage: drive.sh MENISCUS
set -euo pipefail
meniscus=$1
shader=shaders/dots/discs.wgsl
# The colour of the word "error" in the messages (`theme::BAD`).
bad='#EC6860'

"$meniscus" view scenes/dots.ron --size 320x240 2>view.log &
window=$!
trap 'kill $window 2>/dev/null || true' EXIT

shot() { import -window root "$1.png"; }
fail() { echo "window: $*" >&2; cat view.log >&2; exit 1; }
# How many pixels of a screenshot have a colour.
count() { convert "$1.png" -fuzz 8% -fill black +opaque "$2" -fill white -opaque "$2" -format '%[fx:round(mean*w*h)]' info:; }
# How many pixels differ between two screenshots.
differ() { compare -metric AE "$1.png" "$2.png" null: 2>&1 || true; }
# Takes screenshots until a condition holds.
until_so() {
    local name=$1; shift
    for _ in $(seq 120); do
        kill -0 $window 2>/dev/null || fail "it ended while waiting for $name"
        shot "$name"
        if "$@" "$name"; then return; fi
        sleep 0.5
    done
    fail "waited in vain for $name"
}
# The picture is more than its backdrop: many colours in the middle of the window.
has_picture() { [ "$(convert "$1.png" -crop 500x400+400+200 -unique-colors -format '%w' info:)" -gt 60 ]; }
has_error() { [ "$(count "$1" "$bad")" -gt 20 ]; }
has_no_error() { [ "$(count "$1" "$bad")" -eq 0 ]; }
# Compared with the screenshot named first.
is_other() { [ "$(differ "$1" "$2")" -gt 2000 ]; }
is_same() { [ "$(differ "$1" "$2")" -lt 400 ]; }
# The middle of the window alone: times and lists around it change.
middle() { convert "$1.png" -crop 600x640+330+90 +repage "$1-middle.png"; }
same_middle() { middle "$1"; middle "$2"; [ "$(differ "$1-middle" "$2-middle")" -eq 0 ]; }

until_so picture has_picture
has_no_error picture || fail "there is an error before anything was done"
sleep 1; shot picture

# There is no window manager that would give it the keyboard.
xdotool search --name meniscus windowfocus
sleep 0.5; shot picture

# A key: help comes and goes.
xdotool mousemove 640 420 key F1
until_so help is_other picture
xdotool key F1
until_so back same_middle picture

# A click: the graph is drawn, and the picture comes back.
xdotool mousemove 468 47; sleep 0.3; xdotool click 1
until_so graph is_other picture
xdotool mousemove 332 47; sleep 0.3; xdotool click 1; sleep 0.3; xdotool mousemove 640 420
until_so again same_middle picture

# A drag turns the camera, H brings it back.
xdotool mousemove 640 420; sleep 0.2; xdotool mousedown 1; sleep 0.2; xdotool mousemove 700 430; sleep 0.2
xdotool mousemove 760 440; sleep 0.2; xdotool mouseup 1
until_so turned is_other picture
xdotool key h; xdotool mousemove 640 420
until_so home same_middle picture

# A broken shader: the error shows, the picture stays.
cp "$shader" good.wgsl
sed 's/settings.color \* light/settings.hue * light/' good.wgsl >"$shader"
until_so error has_error
has_picture error || fail "the picture went with the error"

# Mended: the error goes, and the picture is as it was.
cp good.wgsl "$shader"
until_so mended has_no_error
until_so recovered same_middle picture

kill -0 $window || fail "it ended"
echo "window: started, drew, took a key, a click and a drag, showed an error, recovered"
