#pragma once
/// Compiled kernels, kept from run to run.
///
/// An entry is a file named after device and options; it holds hashes of the sources and the driver
/// and the program's binary. PoCL is different: it keeps its kernels itself, and asking it for a
/// binary would make it compile the kernel once more, for any size of work-groups. Its entries hold
/// the names and hashes of the files in its cache instead, since a damaged one makes PoCL abort.

#include "cl_context.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace clrender {

class KernelCache {
public:
    /// The entry of the program `text`, compiled with `options` for this device.
    KernelCache(const DeviceEntry &entry, const std::string &text, const std::string &options);

    /// True if the kernel need not be compiled; otherwise why_not() says why it has to be, and what
    /// is damaged is removed.
    bool look_up();
    [[nodiscard]] const std::string &why_not() const { return why_not_; }

    /// What look_up() has found: the binary, or nothing where the driver itself has it.
    [[nodiscard]] const std::vector<unsigned char> &binary() const { return binary_; }

    /// Keeps the program, which has been launched once. What cannot be written is not kept.
    void store(const cl::Program &program) const;

private:
    [[nodiscard]] std::string read_payload();

    bool driver_keeps_kernels_ = false; ///< PoCL
    bool enabled_ = true;
    std::filesystem::path file_;
    std::string identity_; ///< first lines of the entry: what it was made from
    std::filesystem::file_time_type start_;
    std::string why_not_;
    std::vector<unsigned char> binary_;
};

} // namespace clrender
