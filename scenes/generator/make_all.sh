#!/usr/bin/env bash
# Makes scenes/meshes and scenes/textures anew, exactly as they are committed.
# usage: make_all.sh [BUILD_DIRECTORY]   (default: build/generator at the top of the repository)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
scenes=$(dirname "$here")
build=${1:-$(dirname "$scenes")/build/generator}

cmake -S "$here" -B "$build" >/dev/null
cmake --build "$build" >/dev/null
make_mesh=$build/clrender-make-mesh

mkdir -p "$scenes/meshes" "$scenes/textures"
shape() { # NAME TRIANGLES TEXTURE_SIZE
    "$make_mesh" "$1" "$2" "$scenes/meshes/$1.obj" --texture "$scenes/textures/$1.png" --size "$3"
}
shape ammonite 20000 512x1024
shape coral 20000 768x768
shape creature 12000 768x768
shape knot 20000 1024x512
shape ribbon 20000 1024x256
shape vase 20000 1024x512
"$make_mesh" creature 1000 "$scenes/meshes/creature_coarse.obj"
"$make_mesh" sky "$scenes/textures/sky.hdr" --size 512x256
