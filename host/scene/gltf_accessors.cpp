#include "gltf_accessors.h"

#include "../memory_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace clrender::gltf {

namespace {

/// Elements that an accessor without data may have: all are 0 but for a few.
constexpr std::size_t max_absent_elements = std::size_t{1} << 24;

/// A value of a component type, the lowest byte first.
template <typename T> double value_at(const char *bytes) {
    static_assert(std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
}

double component_at(const char *bytes, int type) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return value_at<std::int8_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return value_at<std::uint8_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return value_at<std::int16_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return value_at<std::uint16_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return value_at<std::uint32_t>(bytes);
    default:
        return value_at<float>(bytes);
    }
}

std::size_t size_of_component(int type) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return 4;
    default:
        return 0;
    }
}

std::size_t components_of(int type) {
    switch (type) {
    case TINYGLTF_TYPE_SCALAR:
        return 1;
    case TINYGLTF_TYPE_VEC2:
        return 2;
    case TINYGLTF_TYPE_VEC3:
        return 3;
    case TINYGLTF_TYPE_VEC4:
        return 4;
    case TINYGLTF_TYPE_MAT4:
        return 16;
    default:
        return 0;
    }
}

std::string name_of(int components) {
    return components == 1    ? "SCALAR"
           : components == 16 ? "MAT4"
                              : fmt::format("VEC{}", components);
}

/// `count` elements of a view, which it is certain to hold.
class Elements {
public:
    Elements(const Document &document, int view, std::size_t offset, std::size_t stride,
             std::size_t count, int type, std::size_t components, const std::string &place)
        : bytes_(document.view(view, place)), stride_(stride), type_(type),
          component_(size_of_component(type)) {
        const std::size_t size = component_ * components;
        if (stride_ == 0)
            stride_ = size;
        if (stride_ < size)
            throw document.error(
                place, fmt::format("a stride of {} bytes, expected at least {}", stride_, size));
        if (count > 0 && (offset > bytes_.size() || size > bytes_.size() - offset ||
                          count - 1 > (bytes_.size() - offset - size) / stride_))
            throw document.error(
                place, fmt::format("{} elements of {} bytes from byte {} on do not fit into "
                                   "bufferView {} of {} bytes",
                                   count, size, offset, view, bytes_.size()));
        bytes_.remove_prefix(std::min(offset, bytes_.size()));
    }

    [[nodiscard]] double at(std::size_t element, std::size_t component) const {
        return component_at(&bytes_[element * stride_ + component * component_], type_);
    }

private:
    std::string_view bytes_;
    std::size_t stride_;
    int type_;
    std::size_t component_;
};

/// Calls `take(element, component, value)` for all numbers that an accessor has data for, those of
/// the sparse part last.
template <typename Take>
void for_each_number(const Document &document, const tinygltf::Accessor &accessor,
                     std::size_t components, const std::string &place, const Take &take) {
    if (accessor.bufferView >= 0) {
        const tinygltf::BufferView &view =
            element(document, document.model.bufferViews, accessor.bufferView, "bufferView", place);
        const Elements elements(document, accessor.bufferView, accessor.byteOffset, view.byteStride,
                                accessor.count, accessor.componentType, components, place);
        for (std::size_t i = 0; i < accessor.count; ++i)
            for (std::size_t c = 0; c < components; ++c)
                take(i, c, elements.at(i, c));
    }
    if (!accessor.sparse.isSparse)
        return;
    const auto &sparse = accessor.sparse;
    const int index_type = sparse.indices.componentType;
    if (index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
        index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
        throw document.error(place, fmt::format("sparse indices of component type {}, expected "
                                                "5121, 5123 or 5125",
                                                index_type));
    if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
        throw document.error(place, "a negative number in its sparse part");
    const auto count = static_cast<std::size_t>(sparse.count);
    const Elements indices(document, sparse.indices.bufferView,
                           static_cast<std::size_t>(sparse.indices.byteOffset), 0, count,
                           index_type, 1, place);
    const Elements values(document, sparse.values.bufferView,
                          static_cast<std::size_t>(sparse.values.byteOffset), 0, count,
                          accessor.componentType, components, place);
    for (std::size_t i = 0; i < count; ++i) {
        const auto target = static_cast<std::size_t>(indices.at(i, 0));
        if (target >= accessor.count)
            throw document.error(
                place, fmt::format("sparse index {}, of {} elements", target, accessor.count));
        for (std::size_t c = 0; c < components; ++c)
            take(target, c, values.at(i, c));
    }
}

/// The accessor, with what does not depend on its use checked, and memory claimed for its numbers.
const tinygltf::Accessor &checked(const Document &document, int index, const std::string &place) {
    const tinygltf::Accessor &accessor =
        element(document, document.model.accessors, index, "accessor", place);
    const std::string own = place_of("accessors", index);
    if (size_of_component(accessor.componentType) == 0)
        throw document.error(own, fmt::format("component type {}, expected one of 5120 to 5126, "
                                              "without 5124",
                                              accessor.componentType));
    if (accessor.bufferView < 0 && accessor.count > max_absent_elements)
        throw document.error(own, fmt::format("{} elements without data, expected at most {}",
                                              accessor.count, max_absent_elements));
    // Whatever is stated, no element is shorter than a byte.
    if (accessor.bufferView >= 0 && accessor.count > document.view(accessor.bufferView, own).size())
        throw document.error(own, fmt::format("{} elements do not fit into bufferView {}",
                                              accessor.count, accessor.bufferView));
    const std::size_t components = components_of(accessor.type);
    if (const std::string reason = claim_memory(accessor.count * components * sizeof(float));
        !reason.empty())
        throw document.error(own, reason);
    return accessor;
}

} // namespace

float normalised(double value, int type) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return static_cast<float>(std::max(value / 127, -1.0));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return static_cast<float>(value / 255);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return static_cast<float>(std::max(value / 32767, -1.0));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return static_cast<float>(value / 65535);
    default:
        return static_cast<float>(value);
    }
}

Numbers read_numbers(const Document &document, int index, int least, int most,
                     const std::string &place, bool repairs) {
    const tinygltf::Accessor &accessor = checked(document, index, place);
    const std::string own = place_of("accessors", index);
    Numbers numbers;
    numbers.components = components_of(accessor.type);
    if (numbers.components < static_cast<std::size_t>(least) ||
        numbers.components > static_cast<std::size_t>(most))
        throw document.error(own, fmt::format("has the wrong type for {}, expected {}{}", place,
                                              name_of(least),
                                              most > least ? " to " + name_of(most) : ""));
    numbers.values.resize(accessor.count * numbers.components);
    std::size_t bad = 0;
    for_each_number(
        document, accessor, numbers.components, own,
        [&](std::size_t i, std::size_t c, double value) {
            float result = accessor.normalized ? normalised(value, accessor.componentType)
                                               : static_cast<float>(value);
            if (!std::isfinite(result)) {
                if (!repairs)
                    throw document.error(own, fmt::format("element {} is not finite", i));
                ++bad;
                result = 0;
            }
            numbers.values[i * numbers.components + c] = result;
        });
    if (bad > 0)
        document.warn(own, fmt::format("{} values are not finite, 0 instead", bad));
    return numbers;
}

std::vector<std::uint32_t> read_indices(const Document &document, int index, std::size_t limit,
                                        const std::string &place) {
    const tinygltf::Accessor &accessor = checked(document, index, place);
    const std::string own = place_of("accessors", index);
    if (accessor.type != TINYGLTF_TYPE_SCALAR ||
        (accessor.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
         accessor.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
         accessor.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
        throw document.error(own, "holds no indices, expected unsigned integers of type SCALAR");
    std::vector<std::uint32_t> indices(accessor.count);
    for_each_number(document, accessor, 1, own, [&](std::size_t i, std::size_t, double value) {
        if (value >= static_cast<double>(limit))
            throw document.error(own, fmt::format("index {:.0f}, of {} vertices", value, limit));
        indices[i] = static_cast<std::uint32_t>(value);
    });
    return indices;
}

} // namespace clrender::gltf
