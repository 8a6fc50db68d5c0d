#pragma once
/// Numbers and names out of the text of a scene file, and the wording of errors about them.

#include "../error.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace clrender::mitsuba {

/// `text` in quotes, fit for one line of an error: shortened, no control characters.
std::string in_quotes(std::string_view text);

/// "expected one of: a, b, c", with the candidate that `name` probably means in front.
std::string expected_one_of(std::string_view name, const std::vector<std::string> &candidates);

/// Whether `name` is probably one of the candidates, written wrong.
bool is_misspelt(std::string_view name, const std::vector<std::string> &candidates);

/// Parts of a list separated by spaces and commas.
std::vector<std::string_view> split_list(std::string_view text);

/// One finite number, surrounding blanks allowed. Throws InputError at `where`, naming `what`.
double parse_number(const SourceLocation &where, std::string_view what, std::string_view text);

std::int64_t parse_integer(const SourceLocation &where, std::string_view what,
                           std::string_view text);

/// "true" or "false", in any case.
bool parse_boolean(const SourceLocation &where, std::string_view what, std::string_view text);

/// All numbers of a list, of any length.
std::vector<double> parse_numbers(const SourceLocation &where, std::string_view what,
                                  std::string_view text);

std::string to_lower(std::string text);

} // namespace clrender::mitsuba
