#include "obj_lines.h"

#include "../memory_limit.h"

#include <fmt/format.h>

#include <charconv>
#include <climits>
#include <cmath>
#include <cstring>
#include <limits>

namespace clrender {

namespace {

constexpr std::size_t chunk_size = 1 << 16;
constexpr std::size_t max_line_length = 1 << 20;
constexpr std::string_view blanks = " \t\r\v\f";

/// Consumes an integer and returns false if there is none, if it is 0 or if it does not fit.
bool take_index(const char *&p, const char *end) {
    int value = 0;
    const auto [next, error] = std::from_chars(p, end, value);
    p = next;
    return error == std::errc() && value != 0 && value != INT_MIN;
}

/// A corner of a face: v, v/vt, v//vn or v/vt/vn with nonzero integers.
bool is_corner(std::string_view word) {
    const char *p = word.data();
    const char *end = p + word.size();
    if (!take_index(p, end))
        return false;
    const bool has_uv = end - p > 1 && *p == '/' && p[1] != '/';
    if (has_uv && (++p, !take_index(p, end)))
        return false;
    if (p == end)
        return true;
    p += has_uv ? 1 : 2;
    return p < end && p[-1] == '/' && (has_uv || p[-2] == '/') && take_index(p, end) && p == end;
}

/// `keyword` is followed by at least `least` numbers, and by nothing else.
std::string check_numbers(const std::vector<std::string_view> &words, std::size_t least) {
    if (words.size() < least + 1)
        return fmt::format("{} with {} numbers, expected {}", words[0], words.size() - 1, least);
    for (std::size_t i = 1; i < words.size(); ++i)
        if (std::string reason = check_number(words[i]); !reason.empty())
            return reason;
    return {};
}

std::string check_face(const std::vector<std::string_view> &words) {
    if (words.size() < 4)
        return fmt::format("face with {} vertices, expected at least 3", words.size() - 1);
    for (std::size_t i = 1; i < words.size(); ++i)
        if (!is_corner(words[i]))
            return fmt::format("face vertex {}, expected v, v/vt, v//vn or v/vt/vn with "
                               "indices from 1, or negative ones",
                               quoted(words[i]));
    return {};
}

} // namespace

ObjLines::ObjLines(const std::string &path, const SourceLocation &referrer, Filter filter)
    : path_(path), file_(path, referrer), filter_(std::move(filter)), chunk_(chunk_size) {
    // What a mesh takes in memory, measured against the lines that it is written in.
    constexpr std::uint64_t expansion = 5;
    if (const std::string reason = claim_memory(expansion * file_.size()); !reason.empty())
        throw InputError({path, 0}, reason);
}

ObjLines::int_type ObjLines::underflow() {
    // Lines that the filter empties are passed over.
    do {
        if (!next_line())
            return traits_type::eof();
        check_line();
    } while (line_.empty());
    line_ += '\n';
    setg(line_.data(), line_.data(), line_.data() + line_.size());
    return traits_type::to_int_type(line_[0]);
}

bool ObjLines::next_line() {
    line_.clear();
    if (line_number_ < INT_MAX)
        ++line_number_;
    bool any = false;
    while (true) {
        if (chunk_begin_ == chunk_end_) {
            chunk_begin_ = 0;
            chunk_end_ = file_.read(chunk_.data(), chunk_.size());
            if (chunk_end_ == 0)
                return any;
        }
        any = true;
        const char *begin = chunk_.data() + chunk_begin_;
        const std::size_t left = chunk_end_ - chunk_begin_;
        const auto *newline = static_cast<const char *>(std::memchr(begin, '\n', left));
        const std::size_t count = newline ? static_cast<std::size_t>(newline - begin) : left;
        line_.append(begin, count);
        chunk_begin_ += count + (newline ? 1 : 0);
        if (line_.size() > max_line_length)
            throw InputError(where(), "line longer than 1 MiB, expected a shorter one");
        if (newline)
            return true;
    }
}

void ObjLines::check_line() {
    if (line_number_ == 1 && line_.starts_with("\xEF\xBB\xBF"))
        line_.erase(0, 3);
    if (line_.find('\0') != std::string::npos)
        throw InputError(where(), "NUL byte, expected text");

    // A comment begins at a # that begins a word: names may contain one.
    for (std::size_t hash = line_.find('#'); hash != std::string::npos;
         hash = line_.find('#', hash + 1)) {
        if (hash == 0 || blanks.find(line_[hash - 1]) != std::string_view::npos) {
            line_.erase(hash);
            break;
        }
    }

    // The parser takes a lone carriage return for the end of a line; we take it for a blank.
    for (char &c : line_)
        if (c == '\r' || c == '\v' || c == '\f')
            c = ' ';
    if (line_.find_first_not_of(blanks) == std::string::npos) {
        line_.clear();
        return;
    }
    if (const std::string reason = filter_(line_); !reason.empty())
        throw InputError(where(), reason);
}

std::vector<std::string_view> split_words(std::string_view line) {
    std::vector<std::string_view> words;
    words.reserve(8);
    std::size_t begin = line.find_first_not_of(blanks);
    while (begin != std::string_view::npos) {
        const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
        words.push_back(line.substr(begin, end - begin));
        begin = line.find_first_not_of(blanks, end);
    }
    return words;
}

std::string check_number(std::string_view word) {
    std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    double value = 0;
    const auto [next, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const bool is_number = next == digits.data() + digits.size();
    if (is_number && error == std::errc() && std::abs(value) <= std::numeric_limits<float>::max())
        return {};

    // from_chars reports numbers too close to zero like those too large; only the latter are bad.
    if (is_number && error == std::errc::result_out_of_range &&
        std::abs(std::strtod(std::string(digits).c_str(), nullptr)) < 1)
        return {};
    return quoted(word) + ", expected a finite number";
}

std::string check_obj_line(std::string &line) {
    const std::string_view text = line;
    const std::size_t begin = text.find_first_not_of(blanks);
    const std::string_view keyword = text.substr(begin, text.find_first_of(blanks, begin) - begin);
    if (keyword == "v" || keyword == "vn")
        return check_numbers(split_words(text), 3);
    if (keyword == "vt")
        return check_numbers(split_words(text), 1);
    if (keyword == "f")
        return check_face(split_words(text));
    line.clear();
    return {};
}

std::string quoted(std::string_view word) {
    constexpr std::size_t max_shown = 40;
    std::string shown;
    for (const char c : word.substr(0, max_shown))
        shown += (c >= ' ' && c <= '~') ? c : '?';
    return "'" + shown + (word.size() > max_shown ? "...'" : "'");
}

} // namespace clrender
