#!/bin/sh
# What Debian must bring for pictures by OpenGL and for Open3D: installed where we may, else the one line to run.
# Without it pictures are ray-cast (slower, and the same otherwise), and benchmarks lack their baseline.
packages="libegl1 libgl1 libgl1-mesa-dri libgomp1 libusb-1.0-0"
there() {
    python3 -c 'import ctypes
for name in ("EGL.so.1", "GL.so.1", "gomp.so.1", "usb-1.0.so.0"): ctypes.CDLL("lib" + name)' 2>/dev/null
}
there && exit 0
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "installing $packages"
    if apt-get update -qq >/dev/null 2>&1 &&
        DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $packages >/dev/null 2>&1; then
        exit 0
    fi
fi
echo "For pictures by OpenGL and the baseline of perception (optional): sudo apt-get install $packages"
