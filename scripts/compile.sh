# Sourced by the other scripts: how the program is compiled.

# compile PRESET FOLDER TARGET...: brings targets up to date in the folder of a preset of
# CMakePresets.json. What the tools say is shown where they fail, and on a terminal as one line of
# progress.
compile() {
    local preset=$1 folder=$2
    shift 2

    # Configured once, and again when a build without the tests becomes one with them; after that
    # ninja itself sees when it has to be done again.
    if [ ! -f "$folder/build.ninja" ] ||
        { [ "$preset" = test ] && ! grep -q -E '^CLRENDER_TESTS:BOOL=(TRUE|ON)' "$folder/CMakeCache.txt"; }; then
        mkdir -p "$folder"
        if ! cmake --preset "$preset" >"$folder/configure.log" 2>&1; then
            cat "$folder/configure.log" >&2
            return 1
        fi
    fi

    if [ -t 1 ]; then
        ninja -C "$folder" "$@"
    else
        ninja -C "$folder" --quiet "$@" | sed '/^ninja: no work to do/d'
    fi
}
