/// The corpora of the fuzz targets: small sound files, and inputs that once did harm. Each is read,
/// or refused with one line.

#include "fuzz/readers.h"
#include "program.h"

#include <catch2/catch.hpp>

using namespace clrender::fuzz;
using namespace clrender::test;

TEST_CASE("Every input of the fuzz corpora is read or refused") {
    const fs::path corpora = fs::path(CLRENDER_TEST_DIR) / "fuzz" / "corpus";
    for (const Reader &reader : readers()) {
        int files = 0;
        for (const auto &entry : fs::directory_iterator(corpora / reader.name)) {
            INFO(entry.path().string());
            CHECK_NOTHROW(read_bytes(reader, read_file(entry.path())));
            ++files;
        }
        INFO(reader.name);
        CHECK(files > 0);
    }
}
