"""bench/gpu_registers.py [SCENE...]: what the kernel of each scene costs an NVIDIA GPU, told without
one: registers, bytes of stack and spilled bytes a work-item.

The scene's configuration is the program's own (clrender -v), with what it chooses on a GPU: one lane,
one pixel a work-item, filters sampled. clang makes PTX of it, ptxas machine code for sm_90. NVIDIA's
OpenCL compiler differs from clang by some registers. Needs clang-14, libclc-14 and ptxas, of
NVIDIA's toolkit or of PyPI's nvidia-cuda-nvcc-cu12.
"""

import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
KERNELS = ROOT / "kernels"
OPENCL = ["clang-14", "-x", "cl", "-cl-std=CL1.2", "-I", str(KERNELS)]
PTX = ["-O3", "-target", "nvptx64-nvidia-nvcl", "-Xclang", "-finclude-default-header",
       "-Xclang", "-target-cpu", "-Xclang", "sm_75", "-Xclang", "-mlink-builtin-bitcode",
       "-Xclang", "/usr/lib/clc/nvptx64--nvidiacl.bc", "-S"]
FIELD = re.compile(r"\b([A-Z][A-Z0-9_]*)=(-?\w+)")


def output_of(command, **how):
    return subprocess.run(command, capture_output=True, text=True, check=True, **how)


def defaults():
    """Every value that the kernel is specialised on, as the preprocessor reads the list."""
    text = output_of([*OPENCL, "-E", "-P", "-"], input=(
        "#define CLR_CONFIG(name, value, meaning) name=value\n"
        '#include "shared/kernel_config.def"\n')).stdout
    return dict((name, value) for name, value in
                re.findall(r"(\w+)\s*=\s*(-?\s*\w+)", text))


def configuration(clrender, scene, step, folder):
    """The values of a scene that differ from the defaults, as on a GPU."""
    said = output_of([str(clrender), str(scene), "-v", "-r", "8x8", "-s", "1", "--lanes", "1",
                      "-o", str(folder / "picture.pfm")]).stderr
    line = next(line for line in said.splitlines() if line.startswith("kernel: ") and "=" in line)
    config = dict(FIELD.findall(line))
    config.update(LANES="1", TILE="1", BORDER="0", BVH_STEP=step)
    if config.get("FILTER") in ("3", "CLR_FILTER_SPLATTED"):
        config["FILTER"] = config["FILTER"].replace("3", "1").replace("SPLATTED", "SAMPLED")
    return config


def cost(config, ptxas, folder):
    """(registers, stack, spilled) of path_trace with these values."""
    ptx, binary = folder / "kernel.ptx", folder / "kernel.o"
    options = [f"-D{name}={value}" for name, value in config.items()]
    output_of([*OPENCL, *PTX, *options, "-o", str(ptx), str(KERNELS / "path_trace.cl")])
    said = output_of([ptxas, "-arch", "sm_90", "-v", "-c", str(ptx), "-o", str(binary)]).stderr
    registers = int(re.search(r"Used (\d+) registers", said)[1])
    # The kernel's frame lies below that of the function it calls, the lookup of a texture.
    stack = sum(int(n) for n in re.findall(r"(\d+) bytes stack frame", said))
    spilled = sum(int(n) for n in re.findall(r"(\d+) bytes spill", said))
    return registers, stack, spilled


def main():
    arguments = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments.add_argument("scenes", nargs="*", type=pathlib.Path)
    arguments.add_argument("--clrender", type=pathlib.Path, default=ROOT / "build/clrender")
    arguments.add_argument("--ptxas", default="ptxas")
    arguments.add_argument("--step", default="4", choices=["4", "8"], help="BVH_STEP (default: 4)")
    chosen = arguments.parse_args()
    scenes = chosen.scenes or sorted((ROOT / "scenes").glob("*.xml"))
    print(f"{'scene':<24}{'registers':>10}{'stack':>8}{'spilled':>9}")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for scene in scenes:
            config = {**defaults(), **configuration(chosen.clrender, scene, chosen.step, folder)}
            registers, stack, spilled = cost(config, chosen.ptxas, folder)
            print(f"{scene.stem:<24}{registers:>10}{stack:>8}{spilled:>9}", flush=True)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except subprocess.CalledProcessError as error:
        sys.exit(f"{error.cmd[0]} failed: {error.stderr.strip()}")
