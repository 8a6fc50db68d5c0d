# Sourced by the other scripts: how the program is compiled.

# compile PRESET TARGET...: brings the targets of a preset of CMakePresets.json up to date. What the
# tools say is shown where they fail, and on a terminal as one line of progress.
compile() {
    local preset=$1 folder=build
    shift
    [ "$preset" = release ] || folder=build-$preset

    # Configured once; after that ninja itself sees when it has to be done again.
    if [ ! -f "$folder/build.ninja" ]; then
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
