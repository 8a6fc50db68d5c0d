#include "self_test.h"

#include "checks.h"
#include "device/kernel_program.h"
#include "print.h"
#include "reference_scenes.h"

#include <array>
#include <chrono>
#include <cstdio>
#include <fmt/format.h>

namespace clrender::selftest {

namespace {

/// Of the rays and samples of the full checks: some seconds on one core.
constexpr double share_of_rays = 0.1;

/// Prints the rows as they come, and keeps those that failed.
class Table {
public:
    void add(const std::vector<Check> &rows) {
        for (const Check &row : rows) {
            print("{}\n", describe(row));
            if (!row.passed())
                failed_.push_back(row);
        }
        std::fflush(stdout);
        count_ += rows.size();
    }

    [[nodiscard]] bool all_passed() const { return failed_.empty(); }

    [[nodiscard]] bool finish(const std::string &device, double seconds) const {
        for (const Check &row : failed_)
            print("self-test: {} is wrong: {} is {:.3g}, at most {:.3g} is right\n", row.function,
                  row.what, row.figure, row.bar);
        if (failed_.empty())
            print("self-test: pass: {} checks on {} in {:.1f} s\n", count_, device, seconds);
        else
            print("self-test: FAIL: {} of {} checks on {} in {:.1f} s\n", failed_.size(), count_,
                  device, seconds);
        return failed_.empty();
    }

private:
    std::vector<Check> failed_;
    std::size_t count_ = 0;
};

} // namespace

bool run_self_test(const RenderOptions &how) {
    const auto start = std::chrono::steady_clock::now();
    const DeviceEntry entry = choose_device(how.device);
    const int lanes = how.lanes != 0 ? how.lanes : natural_lanes(entry);
    ProbeDevice device(entry, lanes,
                       how.kernel_dir.empty() ? embedded_kernel_sources()
                                              : read_kernel_sources(how.kernel_dir),
                       share_of_rays);
    Table table;
    for (const auto check : {check_math, check_numbers, check_spheres, check_planars, check_camera,
                             check_filters, check_textures, check_environment, check_lights})
        table.add(check(device));
    // Where functions are wrong, whole pictures say nothing more.
    if (table.all_passed())
        table.add(check_reference_scenes(how));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    return table.finish(fmt::format("{} ({}), {} lanes", entry.name, entry.platform, lanes),
                        took.count());
}

} // namespace clrender::selftest
