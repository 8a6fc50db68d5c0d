#include "gltf_json.h"

#include "../memory_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace clrender::gltf {

namespace {

using nlohmann::json;

/// Objects and arrays within each other; glTF itself has less than ten levels.
constexpr int max_depth = 64;

/// What a value takes at its peak: twice as JSON, and as tinygltf's copy of an extension.
constexpr std::uint64_t bytes_per_value = 400;

/// Counts values and levels of a text, and stops at the first fault.
class Checker : public nlohmann::json_sax<json> {
public:
    std::uint64_t values = 0;
    std::string fault;
    std::size_t fault_at = 0; ///< byte of the text, from 1

    bool null() override { return count(); }
    bool boolean(bool) override { return count(); }
    bool number_integer(number_integer_t) override { return count(); }
    bool number_unsigned(number_unsigned_t) override { return count(); }
    bool number_float(number_float_t value, const string_t &text) override {
        if (std::isfinite(value))
            return count();
        return stop("the number " + text + " is too large");
    }
    bool string(string_t &) override { return count(); }
    bool binary(binary_t &) override { return count(); }
    bool key(string_t &) override { return count(); }
    bool start_object(std::size_t) override { return enter(); }
    bool end_object() override { return leave(); }
    bool start_array(std::size_t) override { return enter(); }
    bool end_array() override { return leave(); }
    bool parse_error(std::size_t position, const std::string &,
                     const nlohmann::detail::exception &error) override {
        // What the library says begins with its own number of the error, and a place.
        std::string text = error.what();
        for (const char *begin : {"syntax error ", "] "})
            if (const auto at = text.find(begin); at != std::string::npos) {
                text = text.substr(at + (begin[0] == 's' ? 0 : 2));
                break;
            }
        fault_at = position;
        return stop(text.substr(0, 200));
    }

private:
    bool count() {
        ++values;
        return true;
    }
    bool enter() {
        ++values;
        return ++depth_ <= max_depth ||
               stop(fmt::format("more than {} objects and arrays within each other", max_depth));
    }
    bool leave() {
        --depth_;
        return true;
    }
    bool stop(const std::string &what) {
        if (fault.empty())
            fault = what;
        return false;
    }

    int depth_ = 0;
};

} // namespace

json parse_json(std::string_view text, const std::string &path, bool has_lines) {
    Checker checker;
    const bool is_sound = json::sax_parse(text.begin(), text.end(), &checker);
    if (!is_sound) {
        const std::size_t at = std::min(checker.fault_at, text.size());
        const int line =
            static_cast<int>(1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n'));
        throw InputError({path, has_lines && checker.fault_at > 0 ? line : 0},
                         "JSON: " + checker.fault + ", expected a glTF file");
    }
    if (const std::string reason = claim_memory(4 * text.size() + bytes_per_value * checker.values);
        !reason.empty())
        throw InputError({path, 0}, "its JSON text " + reason);
    json value =
        json::parse(text.begin(), text.end(), [](int, json::parse_event_t event, json &parsed) {
            return event != json::parse_event_t::key || parsed != "extras";
        });
    if (!value.is_object())
        throw InputError({path, 0}, "the JSON text is no object, expected a glTF file");
    return value;
}

} // namespace clrender::gltf
