/// A libFuzzer target; CLRENDER_FUZZ_READER names its reader.

#include "readers.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tbb/global_control.h>

using namespace clrender::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    // Many short runs on one thread cost less than waking others for each.
    static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    static const Reader reader =
        *std::find_if(readers().begin(), readers().end(),
                      [](const Reader &r) { return r.name == CLRENDER_FUZZ_READER; });
    read_bytes(reader, {reinterpret_cast<const char *>(data), size});
    return 0;
}
