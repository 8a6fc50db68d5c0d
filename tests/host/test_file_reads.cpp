#include "log.h"
#include "scene/file_reads.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <tbb/task_arena.h>
#include <thread>

using namespace clrender;

namespace {

void wait_a_little() {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

} // namespace

TEST_CASE("messages of reads come in the order of asking", "[files]") {
    FileReads reads;
    std::string expected;
    for (int i = 0; i < 20; ++i) {
        reads.add([i] {
            if (i % 3 == 0)
                wait_a_little(); // so that later ones end earlier
            log::warn("first of " + std::to_string(i));
            log::warn("second of " + std::to_string(i));
        });
        for (const char *which : {"first", "second"})
            expected +=
                std::string("clrender: warning: ") + which + " of " + std::to_string(i) + "\n";
    }
    log::Holder shown;
    reads.run();
    CHECK(shown.take() == expected);
    reads.run(); // nothing is left to do
    CHECK(shown.take().empty());
}

TEST_CASE("of several failed reads the first one counts", "[files]") {
    FileReads reads;
    reads.add([] { log::warn("before"); });
    reads.add([] {
        wait_a_little();
        log::warn("of the first");
        throw std::runtime_error("the first");
    });
    reads.add([] {
        log::warn("of the second");
        throw std::runtime_error("the second");
    });
    log::Holder shown;
    CHECK_THROWS_WITH(reads.run(), "the first");
    CHECK(shown.take() == "clrender: warning: before\nclrender: warning: of the first\n");
}

TEST_CASE("reads run side by side", "[files]") {
    if (tbb::this_task_arena::max_concurrency() < 2)
        return;
    // Each of two waits for the other: one after the other, neither would see the other begin.
    std::atomic<int> begun{0};
    std::atomic<int> met{0};
    FileReads reads;
    for (int i = 0; i < 2; ++i)
        reads.add([&] {
            ++begun;
            for (int n = 0; n < 500 && begun < 2; ++n)
                wait_a_little();
            met += begun == 2 ? 1 : 0;
        });
    reads.run();
    CHECK(met == 2);
}
