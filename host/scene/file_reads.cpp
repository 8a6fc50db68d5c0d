#include "file_reads.h"

#include "../log.h"

#include <atomic>
#include <exception>
#include <string>
#include <tbb/parallel_for.h>
#include <utility>

namespace clrender {

namespace {

struct Outcome {
    std::string messages;
    std::exception_ptr failure;
};

Outcome outcome_of(const std::function<void()> &read) {
    Outcome outcome;
    log::Holder holder;
    try {
        read();
    } catch (...) {
        outcome.failure = std::current_exception();
    }
    outcome.messages = holder.take();
    return outcome;
}

} // namespace

void FileReads::add(std::function<void()> read) {
    reads_.push_back(std::move(read));
}

void FileReads::run(bool all_faults) {
    const auto reads = std::exchange(reads_, {});
    std::vector<Outcome> outcomes(reads.size());
    std::atomic<std::size_t> failed{reads.size()}; // what follows a failure need not be read
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, reads.size(), 1),
        [&](const tbb::blocked_range<std::size_t> &range) {
            for (std::size_t i = range.begin(); i < range.end() && i < failed; ++i) {
                outcomes[i] = outcome_of(reads[i]);
                std::size_t before = failed;
                while (!all_faults && outcomes[i].failure && i < before &&
                       !failed.compare_exchange_weak(before, i)) {
                }
            }
        },
        tbb::simple_partitioner());
    std::vector<std::string> faults;
    for (const Outcome &outcome : outcomes) {
        log::pass_on(outcome.messages);
        if (!outcome.failure)
            continue;
        try {
            std::rethrow_exception(outcome.failure);
        } catch (const InputError &error) {
            if (!all_faults)
                throw;
            faults.emplace_back(error.what());
        }
    }
    if (!faults.empty())
        throw InputError(faults);
}

} // namespace clrender
