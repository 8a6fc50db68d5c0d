#!/usr/bin/env python3
"""scripts/tidy.py BUILD [FILE...]: clang-tidy on the files of host/ that have changed.

A file counts as changed when its text, that of a header of the project below it, its compile command
or .clang-tidy is another one than when it last was clean. BUILD/tidy-cache remembers that.
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
INCLUDE = re.compile(rb'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)


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


def tidy(source, build):
    """What clang-tidy has to say of `source`; empty when it is clean."""
    result = subprocess.run([TOOL, "--quiet", "-p", str(build), str(source)],
                            capture_output=True, text=True)
    return "" if result.returncode == 0 else result.stdout or result.stderr


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    cache = build / "tidy-cache"
    cache.mkdir(exist_ok=True)
    settings = (ROOT / ".clang-tidy").read_bytes()
    settings += subprocess.run([TOOL, "--version"], capture_output=True, check=True).stdout

    wanted = [pathlib.Path(name).resolve() for name in sys.argv[2:]]
    changed, seen = [], set()
    for entry in json.loads((build / "compile_commands.json").read_text()):
        source = pathlib.Path(entry["file"])
        # What is compiled in both precisions is one text, and is looked at once.
        if ROOT / "host" not in source.parents or source in seen or (
                wanted and source not in wanted):
            continue
        seen.add(source)
        mark = cache / fingerprint(source, entry["command"], settings)
        if not mark.exists():
            changed.append((source, mark))

    # One clang-tidy a core. A clean file leaves its mark; the others are looked at again next time.
    unclean = 0
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for (source, mark), said in zip(changed, pool.map(lambda c: tidy(c[0], build), changed)):
            if said:
                unclean += 1
                print(said.strip())
            else:
                mark.touch()
    print(f"{len(changed)} files looked at, {unclean} with findings")
    return 1 if unclean else 0


if __name__ == "__main__":
    sys.exit(main())
