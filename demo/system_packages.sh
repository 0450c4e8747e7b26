#!/bin/sh
# What Debian must bring for pictures by OpenGL, for Open3D, and for the tests of the page in a browser: installed
# where we may, else the one line to run. Without it pictures are ray-cast (slower, and the same otherwise),
# benchmarks lack their baseline, and the tests of the page are skipped.
libraries="libegl1 libgl1 libgl1-mesa-dri libgomp1 libusb-1.0-0"
have_libraries() {
    python3 -c 'import ctypes
for name in ("EGL.so.1", "GL.so.1", "gomp.so.1", "usb-1.0.so.0"): ctypes.CDLL("lib" + name)' 2>/dev/null
}
have_browser() {
    command -v chromium || command -v chromium-browser || command -v google-chrome
}
packages=""
have_libraries || packages="$libraries"
have_browser >/dev/null || packages="$packages chromium"
[ -z "$packages" ] && exit 0
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "installing" $packages
    apt-get update -qq >/dev/null 2>&1
    missing=""
    for package in $packages; do
        DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$package" >/dev/null 2>&1 ||
            missing="$missing $package"
    done
    packages="$missing"
    [ -z "$packages" ] && exit 0
fi
echo "For pictures by OpenGL, the baseline of perception and the tests of the page (optional):" \
    sudo apt-get install $packages
