#pragma once
/// The kernels' BSDFs (probes/bsdf_probes.cl) for tests.

#include "cl_test_device.h"
#include "config/kernel_config.h"
#include "shared/bsdf_parameters.h"
#include "shared/scene_data.h"

#include <glm/glm.hpp>

#include <map>
#include <vector>

namespace clrender::test {

/// A material: its kind with flags, its parameters in the order of bsdf_parameters.h, and the table
/// of a rough plastic.
struct ProbedBsdf {
    uint kind = 0;
    std::vector<glm::dvec3> parameters;
    std::vector<double> table{};
};

struct BsdfQuery {
    glm::dvec3 wi, wo;
    glm::dvec3 u{0.5}; ///< u_lobe, u1, u2
};

struct BsdfAnswer {
    glm::dvec3 value; ///< times cosine, at wo
    double pdf;
    glm::dvec3 sampled, weight;
    double sampled_pdf, eta;
};

/// Kernels are compiled once for each kind, width and precision.
class BsdfProbe {
public:
    /// All of one kind, in single precision of this width, or in double.
    std::vector<BsdfAnswer> run(const ProbedBsdf &bsdf, const std::vector<BsdfQuery> &queries,
                                int lanes, bool is_double = false);

private:
    template <class Real>
    std::vector<BsdfAnswer> run_as(const ProbedBsdf &bsdf, const std::vector<BsdfQuery> &queries,
                                   int lanes);
    cl::Kernel kernel(uint kind, int lanes, bool is_double);

    ClTestDevice device_;
    std::map<std::tuple<uint, int, bool>, cl::Program> programs_;
};

} // namespace clrender::test
