/// Devices that are not there, that fail, and kernels that do not build: exit code 3, the reason in
/// one line, and no picture.

// The sanitizers take what OpenCL runtimes leak for failures of the program.
#ifndef CLRENDER_SANITIZE

#include "program.h"
#include "small_scene.h"

#include <catch2/catch.hpp>

using namespace clrender::test;

namespace {

/// The lines of `text` that the program has written; runtimes add their own.
std::vector<std::string> own_lines(const std::string &text) {
    std::vector<std::string> lines;
    std::istringstream all(text);
    for (std::string line; std::getline(all, line);)
        if (line.rfind("clrender: ", 0) == 0)
            lines.push_back(line);
    return lines;
}

void check_failure(const TempFolder &folder, const ProgramResult &result,
                   const std::string &reason) {
    INFO(result.err);
    CHECK(result.exit_code == 3);
    const auto lines = own_lines(result.err);
    REQUIRE(lines.size() == 1);
    CHECK_THAT(lines[0], Catch::Contains(reason));
    CHECK_FALSE(folder.has("a.pfm"));
}

} // namespace

TEST_CASE("Without an OpenCL platform the package to install is named") {
    const TempFolder folder;
    folder.write("scene.xml", lit_floor);
    const std::string nowhere = folder.path().string() + "/";
    folder.write("broken.icd", "libno_such_runtime.so\n");
    for (const std::string &vendors : {nowhere + "none/", nowhere}) {
        const ProgramResult result = run_clrender(folder.path(), {"scene.xml", "-o", "a.pfm"},
                                                  {{"OCL_ICD_VENDORS", vendors}});
        check_failure(folder, result, "pocl-opencl-icd");
        CHECK(run_clrender(folder.path(), {"--list-devices"}, {{"OCL_ICD_VENDORS", vendors}})
                  .exit_code == 3);
    }
}

TEST_CASE("A device that fails ends the run with the call that failed") {
    const TempFolder folder;
    folder.write("scene.xml", lit_floor);
    REQUIRE(run_clrender(folder.path(), {"scene.xml", "-o", "warm.pfm"}).exit_code == 0);
    struct Failure {
        std::string call, after, reason;
    };
    for (const Failure &failure :
         {Failure{"clCreateContext", "0", "clCreateContext returned -2"},
          Failure{"clBuildProgram", "0", "the kernel does not compile"},
          Failure{"clCreateBuffer", "5", "clCreateBuffer returned -4"},
          Failure{"clEnqueueNDRangeKernel", "2", "clEnqueueNDRangeKernel returned -5"},
          Failure{"clWaitForEvents", "2", "clWaitForEvents returned -14"}}) {
        INFO(failure.call);
        const ProgramResult result =
            run_clrender(folder.path(), {"scene.xml", "-r", "256x192", "-s", "256", "-o", "a.pfm"},
                         {{"LD_PRELOAD", CLRENDER_FAILING_DEVICE},
                          {"FAILING_CALL", failure.call},
                          {"FAILING_AFTER", failure.after}});
        check_failure(folder, result, failure.reason);
    }
}

TEST_CASE("A syntax error in --kernel-dir is told in one line with its place") {
    const TempFolder folder;
    folder.write("scene.xml", lit_floor);
    fs::create_directory(folder.path() / "kernels");
    folder.write("kernels/path_trace.cl", "/* two\n   lines */\nint broken( { return 0; }\n");
    const ProgramResult result =
        run_clrender(folder.path(), {"scene.xml", "-q", "--kernel-dir", "kernels", "-o", "a.pfm"});
    check_failure(folder, result, "path_trace.cl:3:");
}

#endif
