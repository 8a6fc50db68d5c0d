#!/usr/bin/env python3
"""scripts/tidy.py BUILD [FILE...]: clang-tidy on the files of host/ that have changed.

A file counts as changed when its text, that of a header of the project below it, its compile command
or .clang-tidy is another one than when it last was clean. BUILD/tidy-cache remembers that. The plugin
scripts/tidy_scope.cpp is compiled to there as well.
"""

import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys

TOOL = "clang-tidy-14"
ROOT = pathlib.Path(__file__).resolve().parent.parent
PLUGIN = ROOT / "scripts" / "tidy_scope.cpp"
LLVM = "/usr/lib/llvm-14/include"
INCLUDE = re.compile(rb'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
PRECOMPILED = re.compile(r" -Winvalid-pch -include \S+/cmake_pch\.hxx")


def with_headers(source):
    """`source` and every file of the project that it includes, sorted."""
    found, todo = set(), [source]
    while todo:
        file = todo.pop()
        if file in found:
            continue
        found.add(file)
        for name in INCLUDE.findall(file.read_bytes()):
            for folder in (file.parent, ROOT / "host", ROOT / "kernels"):
                header = (folder / os.fsdecode(name)).resolve()
                if header.is_file():
                    todo.append(header)
                    break
    return sorted(found)


def fingerprint(source, command, settings):
    """A hash of all that decides what clang-tidy says of `source`."""
    digest = hashlib.sha256(settings + command.encode())
    for file in with_headers(source):
        digest.update(str(file.relative_to(ROOT)).encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()


def write_commands(build, cache):
    """The compile commands of host/ by file, also written to `cache` for clang-tidy.

    clang-tidy looks at a file once for each of its commands. What is compiled in both precisions is
    one text, so its commands in double precision are left out; and g++'s precompiled headers, which
    clang cannot read.
    """
    entries = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        source = pathlib.Path(entry["file"])
        if ROOT / "host" in source.parents and "-DCLR_DOUBLE=1" not in entry["command"]:
            entries[source] = {**entry, "command": PRECOMPILED.sub("", entry["command"])}
    (cache / "compile_commands.json").write_text(json.dumps(list(entries.values())))
    return {source: entry["command"] for source, entry in entries.items()}


def build_plugin(cache):
    """The compiled plugin; LLVM is built without run-time type information."""
    library = cache / f"tidy_scope-{hashlib.sha256(PLUGIN.read_bytes()).hexdigest()[:16]}.so"
    if not library.exists():
        unfinished = library.with_suffix(".tmp")
        subprocess.run(["g++", "-std=c++17", "-fPIC", "-shared", "-fno-rtti", "-isystem", LLVM,
                        str(PLUGIN), "-o", str(unfinished)], check=True)
        unfinished.rename(library)
    return library


def tidy(source, plugin, commands):
    """What clang-tidy has to say of `source`; empty when it is clean."""
    result = subprocess.run([TOOL, "--quiet", "-load", str(plugin), "-p", str(commands), str(source)],
                            capture_output=True, text=True)
    return "" if result.returncode == 0 else result.stdout or result.stderr


def finds_a_fault(plugin, cache):
    """True if clang-tidy with the plugin still finds what is wrong in a file of one fault."""
    fault = cache / "fault.cpp"
    fault.write_text("#include <cstddef>\nint *nothing = 0;\n")
    result = subprocess.run([TOOL, "--quiet", "-load", str(plugin), str(fault), "--"],
                            capture_output=True, text=True)
    return "modernize-use-nullptr" in result.stdout


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    cache = build / "tidy-cache"
    cache.mkdir(exist_ok=True)
    settings = (ROOT / ".clang-tidy").read_bytes() + PLUGIN.read_bytes()
    settings += subprocess.run([TOOL, "--version"], capture_output=True, check=True).stdout

    wanted = [pathlib.Path(name).resolve() for name in sys.argv[2:]]
    changed = []
    for source, command in write_commands(build, cache).items():
        mark = cache / fingerprint(source, command, settings)
        if not mark.exists() and (not wanted or source in wanted):
            changed.append((source, mark))
    plugin = build_plugin(cache)
    if not finds_a_fault(plugin, cache):
        print("clang-tidy with scripts/tidy_scope.cpp does not find a known fault")
        return 1

    # One clang-tidy a core. A clean file leaves its mark; the others are looked at again next time.
    unclean = 0
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for (source, mark), said in zip(changed, pool.map(lambda c: tidy(c[0], plugin, cache), changed)):
            if said:
                unclean += 1
                print(said.strip())
            else:
                mark.touch()
    print(f"{len(changed)} files looked at, {unclean} with findings")
    return 1 if unclean else 0


if __name__ == "__main__":
    sys.exit(main())
