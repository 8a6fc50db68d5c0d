#pragma once
/// The lines of an OBJ or MTL file, checked one by one before the parser library sees them.

#include "../input_file.h"

#include <functional>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

namespace clrender {

/// A stream of the lines that pass a filter, for a parser that reads from a std::istream. Throws
/// InputError with the line's number; the stream has to rethrow (`exceptions(badbit)`).
class ObjLines : public std::streambuf {
public:
    /// Sees each line without its end and without comment; returns what is wrong with it ("" if
    /// nothing), and empties a line that the parser is not to see.
    using Filter = std::function<std::string(std::string &line)>;

    ObjLines(const std::string &path, const SourceLocation &referrer, Filter filter);

    /// The line that was handed out last; its first one, if it is continued.
    [[nodiscard]] SourceLocation where() const { return {path_, first_number_}; }

protected:
    int_type underflow() override;

private:
    bool next_line();
    bool append_line();
    void erase_comment(std::size_t begin);
    void check_line();

    std::string path_;
    InputFile file_;
    Filter filter_;
    std::vector<char> chunk_;
    std::size_t chunk_begin_ = 0, chunk_end_ = 0;
    std::string line_;
    int line_number_ = 0, first_number_ = 0;
    bool after_return_ = false; ///< the last line has ended with a carriage return
};

/// The words of a line, separated by blanks.
std::vector<std::string_view> split_words(std::string_view line);

/// The words of a text with one blank between them: a name as it counts.
std::string joined_words(std::string_view text);

/// "" if `word` is a number that fits a 32-bit float, else what is wrong with it.
std::string check_number(std::string_view word);

/// What is wrong with a `v`, `vn`, `vt` or `f` line of an OBJ file; "" if nothing. Indices are
/// checked for their form, not for their range. Empties lines of any other kind.
std::string check_obj_line(std::string &line);

/// `word` in quotes, shortened and without unprintable bytes, for an error message.
std::string quoted(std::string_view word);

} // namespace clrender
