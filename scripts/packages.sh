# Sourced by the other scripts: the one list of the Debian packages that the project needs, and how
# to get those that are missing.

# To build clrender.
build_packages=(
    g++ cmake ninja-build
    ocl-icd-opencl-dev opencl-clhpp-headers
    libpugixml-dev libcli11-dev nlohmann-json3-dev libfmt-dev libtbb-dev libopenexr-dev libglm-dev
    libtinyobjloader-dev libtinygltf-dev libdraco-dev libstb-dev libpng-dev zlib1g-dev
)
# To run it: an OpenCL runtime for the CPU.
run_packages=(pocl-opencl-icd)
# To test it.
test_packages=(catch2 clang-14 clang-format-14 clang-tidy-14 libclang-14-dev llvm-14-dev oclgrind python3)
# To test it on Intel's runtime, which comes from PyPI.
intel_packages=(python3-venv)
# To give its readers made-up input (scripts/fuzz).
fuzz_packages=(clang-14 libclang-rt-14-dev)
# To measure it beside the renderers that PyPI has; Mitsuba compiles with LLVM.
peer_packages=(python3-venv libllvm19)

# missing_packages NAME...: prints those that are not installed.
missing_packages() {
    local name
    for name in "$@"; do
        dpkg-query -W -f '${db:Status-Status}\n' "$name" 2>/dev/null | grep -qx installed || echo "$name"
    done
}

# need_debian: stops where packages cannot be looked up, unless CLRENDER_NO_PACKAGES=1 says that the
# user has seen to them.
need_debian() {
    command -v dpkg-query >/dev/null && return
    echo "error: this is not Debian 12 or a relative of it. Install what these packages hold and set CLRENDER_NO_PACKAGES=1:" >&2
    echo "  $*" >&2
    exit 1
}

# require_packages NAME...: stops with the line to type if one is missing.
require_packages() {
    [ -z "${CLRENDER_NO_PACKAGES:-}" ] || return 0
    need_debian "$@"
    local missing
    missing=$(missing_packages "$@" | xargs)
    [ -n "$missing" ] || return 0
    echo "error: these packages are missing: $missing" >&2
    echo "  apt-get install $missing" >&2
    exit 1
}

# install_packages NAME...: installs the missing ones, as root or through sudo, and says so first;
# stops with the line to type where it may not.
install_packages() {
    [ -z "${CLRENDER_NO_PACKAGES:-}" ] || return 0
    need_debian "$@"
    local missing as_root=()
    missing=$(missing_packages "$@" | xargs)
    [ -n "$missing" ] || return 0

    # sudo asks for a password only where somebody can type it.
    if [ "$(id -u)" -ne 0 ]; then
        if command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then
            as_root=(sudo)
        else
            require_packages "$@"
        fi
    fi

    echo "Installing: $missing"
    local log
    log=$(mktemp)
    # shellcheck disable=SC2086 # a list of words
    if ! "${as_root[@]}" apt-get update >"$log" 2>&1 ||
        ! "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
            apt-get install -y --no-install-recommends $missing >>"$log" 2>&1; then
        tail -n 20 "$log" >&2
        rm -f "$log"
        echo "error: the installation failed (above: the end of what apt-get said)" >&2
        require_packages "$@"
        exit 1
    fi
    rm -f "$log"
}
