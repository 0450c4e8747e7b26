#!/bin/sh
# OpenGL for pictures of the scene: installed where we may, else the one line to run.
# Without it pictures are ray-cast: slower, and the same otherwise.
packages="libegl1 libgl1 libgl1-mesa-dri"
if python3 -c 'import ctypes; ctypes.CDLL("libEGL.so.1"); ctypes.CDLL("libGL.so.1")' 2>/dev/null; then
    exit 0
fi
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "installing $packages for rendering"
    if apt-get update -qq >/dev/null 2>&1 &&
        DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $packages >/dev/null 2>&1; then
        exit 0
    fi
fi
echo "For pictures by OpenGL (optional, else they are ray-cast): sudo apt-get install $packages"
