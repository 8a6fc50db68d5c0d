#include "bsdf_probe.h"

#include <algorithm>

namespace clrender::test {

namespace {

constexpr std::size_t parameters = CLR_MOST_BSDF_PARAMETERS;
constexpr std::size_t in_size = 9, out_size = 12;

glm::dvec3 vector_at(const auto *values) {
    return {values[0], values[1], values[2]};
}

} // namespace

cl::Kernel BsdfProbe::kernel(uint kind, int lanes, bool is_double) {
    const auto [found, is_new] = programs_.try_emplace({kind, lanes, is_double});
    if (is_new) {
        KernelConfig config;
        config.LANES = lanes;
        config.DOUBLE_PRECISION = is_double ? 1 : 0;
        config.HAS_GGX = config.HAS_BECKMANN = 1;
        config.BSDF_PARAMETERS = CLR_MOST_BSDF_PARAMETERS;
#define CLR_BSDF(KIND, name, width, lobes, meaning) config.HAS_##KIND = kind == CLR_BSDF_##KIND;
#include "shared/bsdf_list.def"
        found->second = device_.build("probes/bsdf_probes.cl", config.build_options());
    }
    return {found->second, "probe_bsdf"};
}

template <class Real>
std::vector<BsdfAnswer> BsdfProbe::run_as(const ProbedBsdf &bsdf,
                                          const std::vector<BsdfQuery> &queries, int lanes) {
    std::vector<Real> in, table(bsdf.table.begin(), bsdf.table.end());
    const auto push = [](std::vector<Real> &to, const glm::dvec3 &v) {
        for (int c = 0; c < 3; ++c)
            to.push_back(static_cast<Real>(v[c]));
    };
    std::vector<Real> material{static_cast<Real>(bsdf.kind)};
    for (std::size_t i = 0; i < parameters; ++i)
        push(material, i < bsdf.parameters.size() ? bsdf.parameters[i] : glm::dvec3(0));
    in.reserve(queries.size() * in_size);
    for (const BsdfQuery &query : queries)
        for (const glm::dvec3 &v : {query.wi, query.wo, query.u})
            push(in, v);
    table.resize(std::max<std::size_t>(table.size(), CLR_BOUNDARY_COSINES));

    cl::Kernel kernel =
        this->kernel(bsdf.kind & CLR_BSDF_KIND_MASK, lanes, sizeof(Real) == sizeof(double));
    const cl::Buffer tables = device_.upload<Real>(table), records = device_.upload<Real>(in);
    const cl::Buffer parameters_of_all = device_.upload<Real>(material);
    const cl::Buffer results = device_.allocate(queries.size() * out_size * sizeof(Real));
    kernel.setArg(0, tables);
    kernel.setArg(1, parameters_of_all);
    kernel.setArg(2, records);
    kernel.setArg(3, results);
    kernel.setArg(4, static_cast<cl_uint>(queries.size()));
    const auto width = static_cast<std::size_t>(lanes);
    device_.run(kernel, (queries.size() + width - 1) / width);
    const auto out = device_.download<Real>(results, queries.size() * out_size);

    std::vector<BsdfAnswer> answers;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const Real *a = &out[out_size * i];
        answers.push_back({vector_at(a), a[3], vector_at(a + 4), vector_at(a + 7), a[10], a[11]});
    }
    return answers;
}

std::vector<BsdfAnswer> BsdfProbe::run(const ProbedBsdf &bsdf,
                                       const std::vector<BsdfQuery> &queries, int lanes,
                                       bool is_double) {
    return is_double ? run_as<double>(bsdf, queries, 1) : run_as<float>(bsdf, queries, lanes);
}

} // namespace clrender::test
