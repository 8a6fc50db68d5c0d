#include "mitsuba_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <system_error>
#include <utility>

namespace clrender::mitsuba {

namespace {

/// Insertions, deletions, replacements and swaps of neighbours that lead from `a` to `b` (optimal
/// string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1);
    std::vector<std::size_t> last(b.size() + 1);
    std::iota(last.begin(), last.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::vector<std::size_t> row(b.size() + 1);
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            row[j + 1] = std::min({row[j] + 1, last[j + 1] + 1, last[j] + (a[i] == b[j] ? 0 : 1)});
            if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j])
                row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
        }
        before = std::move(last);
        last = std::move(row);
    }
    return last.back();
}

/// True for another ending of the same word: "rotation" for "rotate".
bool has_other_ending(const std::string &name, const std::string &candidate) {
    constexpr std::size_t shortest_stem = 4;
    constexpr std::size_t longest_ending = 3;
    const auto stem = static_cast<std::size_t>(
        std::mismatch(name.begin(), name.end(), candidate.begin(), candidate.end()).first -
        name.begin());
    return stem >= std::max(shortest_stem, candidate.size() - 1) &&
           name.size() <= candidate.size() + longest_ending;
}

/// The candidate next to `name`, if `name` is likely to be a misspelling of it: an edit in four
/// letters, or another ending. Those further off are other words: "roughconductor" is no
/// misspelling of "conductor".
std::optional<std::string> nearest(std::string_view name,
                                   const std::vector<std::string> &candidates) {
    constexpr std::size_t longest = 40;
    constexpr std::size_t letters_an_edit = 4;
    if (name.size() > longest)
        return std::nullopt;
    const std::string word = to_lower(std::string(name));
    std::optional<std::string> best;
    std::size_t best_distance = longest;
    for (const std::string &candidate : candidates) {
        const std::string other = to_lower(candidate);
        const std::size_t distance = edit_distance(word, other);
        const std::size_t letters = std::min(word.size(), other.size());
        const std::size_t limit = std::max<std::size_t>(1, letters / letters_an_edit);
        const bool is_near = distance < letters && distance <= limit;
        if (distance < best_distance && (is_near || has_other_ending(word, other))) {
            best = candidate;
            best_distance = distance;
        }
    }
    return best;
}

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back()))
        text.remove_suffix(1);
    return text;
}

/// Blanks and one plus sign in front are allowed in numbers, but std::from_chars knows neither.
std::string_view digits_of(std::string_view text) {
    text = trimmed(text);
    if (text.size() > 1 && text[0] == '+' && text[1] != '-')
        text.remove_prefix(1);
    return text;
}

[[noreturn]] void fail(const SourceLocation &where, std::string_view what, std::string_view text,
                       const std::string &expected) {
    throw InputError(where,
                     std::string(what) + " is " + in_quotes(text) + ", expected " + expected);
}

} // namespace

std::string in_quotes(std::string_view text) {
    constexpr std::size_t longest = 80;
    std::string result = "\"";
    for (const char c : text.substr(0, longest))
        result += std::iscntrl(static_cast<unsigned char>(c)) != 0 ? '?' : c;
    return result + (text.size() > longest ? "...\"" : "\"");
}

std::string expected_one_of(std::string_view name, const std::vector<std::string> &candidates) {
    constexpr std::size_t shown = 40;
    if (candidates.empty())
        return "expected nothing of that kind";
    std::string result = "expected one of: ";
    for (std::size_t i = 0; i < std::min(candidates.size(), shown); ++i)
        result += (i > 0 ? ", " : "") + candidates[i];
    if (candidates.size() > shown)
        result += ", ... (" + std::to_string(candidates.size()) + " in all)";
    if (const auto meant = nearest(name, candidates))
        return "did you mean \"" + *meant + "\"? " + result;
    return result;
}

bool is_misspelt(std::string_view name, const std::vector<std::string> &candidates) {
    return nearest(name, candidates).has_value();
}

std::vector<std::string_view> split_list(std::string_view text) {
    std::vector<std::string_view> parts;
    const std::string_view separators = " ,\t\r\n";
    for (std::size_t at = text.find_first_not_of(separators); at != std::string_view::npos;) {
        const std::size_t end = std::min(text.find_first_of(separators, at), text.size());
        parts.push_back(text.substr(at, end - at));
        at = text.find_first_not_of(separators, end);
    }
    return parts;
}

double parse_number(const SourceLocation &where, std::string_view what, std::string_view text) {
    const std::string_view digits = digits_of(text);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::result_out_of_range)
        fail(where, what, text, "a number between 1e-307 and 1e308 in size");
    if (error != std::errc{} || end != digits.data() + digits.size())
        fail(where, what, text, "a number");
    if (!std::isfinite(value))
        fail(where, what, text, "a finite number");
    return value;
}

std::int64_t parse_integer(const SourceLocation &where, std::string_view what,
                           std::string_view text) {
    const std::string_view digits = digits_of(text);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::result_out_of_range)
        fail(where, what, text, "an integer of at most 64 bits");
    if (error != std::errc{} || end != digits.data() + digits.size())
        fail(where, what, text, "an integer");
    return value;
}

bool parse_boolean(const SourceLocation &where, std::string_view what, std::string_view text) {
    const std::string value = to_lower(std::string(text));
    if (value != "true" && value != "false")
        fail(where, what, text, "\"true\" or \"false\"");
    return value == "true";
}

std::vector<double> parse_numbers(const SourceLocation &where, std::string_view what,
                                  std::string_view text) {
    std::vector<double> numbers;
    for (const std::string_view part : split_list(text))
        numbers.push_back(parse_number(where, what, part));
    return numbers;
}

std::string to_lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

} // namespace clrender::mitsuba
