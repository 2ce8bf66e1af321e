#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace shadowcache {

/// Whole content of a file.
///
/// @throws Error if it is missing, a directory, empty or unreadable
std::string readFileBytes(const std::filesystem::path& path);

/// Refuses what readFileBytes would refuse, without reading the file.
void requireReadableFile(const std::filesystem::path& path);

/// A text without the UTF-8 byte order mark that it may begin with.
///
/// @throws Error naming the file for text in UTF-16
std::string_view withoutByteOrderMark(const std::filesystem::path& path, std::string_view text);

/// Makes LF of the line breaks of a text whose lines end in CR alone, as those of old Macs.
///
/// @param size  bytes of `text` that are looked at
void useLineFeeds(std::string& text, std::size_t size = std::string::npos);

/// Walks through a text by lines and blank-separated words; keeps the line's number for messages.
class TextScanner {
public:
    /// `text` must outlive the scanner. '#' starts a comment if `comments` says so.
    TextScanner(const std::filesystem::path& path, std::string_view text, bool comments,
                std::size_t firstLine = 1);

    bool atEnd() const { return at_ == end_; }
    /// Whether nothing but blanks and comments follows on this line; passes over them.
    bool atLineEnd() {
        skipBlanks();
        return at_ == end_ || *at_ == '\n';
    }
    std::size_t line() const { return line_; }
    std::size_t bytesLeft() const { return static_cast<std::size_t>(end_ - at_); }
    std::string_view rest() const { return {at_, bytesLeft()}; }

    /// Next word of this line; empty at the line's end. A backslash joins two lines.
    std::string_view wordOnLine();
    /// Next word of this line or a later one; empty at the text's end.
    std::string_view word();
    /// What follows on this line, blanks at both ends removed; comments are not seen.
    std::string_view restOfLine() const;
    /// Goes to the start of the next line; true if a line break was there.
    bool nextLine();

    /// Value of a word: NaN and Inf as written, Inf of its sign if too large for a double.
    ///
    /// @throws Error if it is not a number
    double number(std::string_view word) const;
    /// Value of a word that must be a whole number, clamped to 64 bits.
    long long integer(std::string_view word) const;

    /// Throws Error "PATH: line N: CAUSE".
    [[noreturn]] void fail(const std::string& cause) const;

private:
    /// Bytes of a backslash and line break here, or 0.
    int joinLength() const;
    void skipBlanks();

    std::filesystem::path path_;
    const char* at_;
    const char* end_;
    std::size_t line_;
    bool comments_;
};

}  // namespace shadowcache
