#include "common/base/file_bytes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <limits>

#include "common/base/error.h"
#include "common/base/memory_limit.h"

namespace shadowcache {

namespace {

/// Words longer than this are shortened in messages.
constexpr std::size_t kQuotedLength = 40;

std::string quoted(std::string_view word) {
    std::string text = "'";
    for (const char c : word.substr(0, kQuotedLength)) text += c >= ' ' && c < '\x7f' ? c : '?';
    return text + (word.size() > kQuotedLength ? "...'" : "'");
}

std::string_view withoutPlus(std::string_view word) {
    return word.size() > 1 && word[0] == '+' ? word.substr(1) : word;
}

}  // namespace

void requireReadableFile(const std::filesystem::path& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) throwFileError(path, "no such file");
    if (std::filesystem::is_directory(status)) {
        throwFileError(path, "is a directory, expected a file");
    }
    // Opening a pipe waits for who writes to it.
    if (!std::filesystem::is_regular_file(status))
        throwFileError(path, "has no known size, expected an ordinary file");
    const std::ifstream file(path, std::ios::binary);
    if (!file) throwFileError(path, std::string("cannot be opened: ") + std::strerror(errno));
    if (std::filesystem::file_size(path, error) == 0) throwFileError(path, "is empty");
}

std::string readFileBytes(const std::filesystem::path& path) {
    requireReadableFile(path);
    requireFitsMemory(path);
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const std::streamoff size = file.tellg();
    if (size <= 0) throwFileError(path, "has no known size, expected an ordinary file");
    std::string bytes(static_cast<std::size_t>(size), '\0');
    file.seekg(0);
    file.read(bytes.data(), size);
    if (!file) throwFileError(path, "cannot be read to its end");
    return bytes;
}

std::string_view withoutByteOrderMark(const std::filesystem::path& path, std::string_view text) {
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
        throwFileError(path, "is text in UTF-16, expected ASCII or UTF-8");
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    return text;
}

void useLineFeeds(std::string& text, std::size_t size) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(size, text.size()));
    if (std::find(text.begin(), end, '\n') == end) std::replace(text.begin(), end, '\r', '\n');
}

TextScanner::TextScanner(const std::filesystem::path& path, std::string_view text, bool comments,
                         std::size_t firstLine)
    : path_(path),
      at_(text.data()),
      end_(text.data() + text.size()),
      line_(firstLine),
      comments_(comments) {}

int TextScanner::joinLength() const {
    if (at_ == end_ || *at_ != '\\') return 0;
    const std::string_view following = rest().substr(1);
    if (following.starts_with('\n')) return 2;
    return following.starts_with("\r\n") ? 3 : 0;
}

void TextScanner::skipBlanks() {
    while (at_ != end_) {
        if (*at_ == ' ' || *at_ == '\t' || *at_ == '\r' || *at_ == '\v' || *at_ == '\f') {
            ++at_;
        } else if (const int join = joinLength(); join > 0) {
            at_ += join;
            ++line_;
        } else if (*at_ == '#' && comments_) {
            while (at_ != end_ && *at_ != '\n') ++at_;
        } else {
            return;
        }
    }
}

std::string_view TextScanner::wordOnLine() {
    skipBlanks();
    const char* begin = at_;
    while (at_ != end_ && static_cast<unsigned char>(*at_) > ' ' && joinLength() == 0) ++at_;
    // A control byte becomes a word of its own, which the parser then refuses.
    if (at_ == begin && at_ != end_ && *at_ != '\n') ++at_;
    return {begin, static_cast<std::size_t>(at_ - begin)};
}

std::string_view TextScanner::word() {
    while (true) {
        const std::string_view found = wordOnLine();
        if (!found.empty() || atEnd()) return found;
        nextLine();
    }
}

std::string_view TextScanner::restOfLine() const {
    constexpr std::string_view kBlanks = " \t\r\v\f";
    const std::string_view line = rest().substr(0, rest().find('\n'));
    const std::size_t first = line.find_first_not_of(kBlanks);
    if (first == line.npos) return {};
    return line.substr(first, line.find_last_not_of(kBlanks) + 1 - first);
}

bool TextScanner::nextLine() {
    const auto* lineBreak = static_cast<const char*>(
        at_ == end_ ? nullptr : std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_)));
    at_ = lineBreak ? lineBreak + 1 : end_;
    ++line_;
    return lineBreak != nullptr;
}

double TextScanner::number(std::string_view word) const {
    const std::string_view digits = withoutPlus(word);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (stop == digits.data() + digits.size() && !digits.empty()) {
        if (error == std::errc{}) return value;
        if (error == std::errc::result_out_of_range) {
            const bool tiny = digits.find("e-") != digits.npos || digits.find("E-") != digits.npos;
            const double infinity = std::numeric_limits<double>::infinity();
            return tiny ? 0.0 : digits.starts_with('-') ? -infinity : infinity;
        }
    }
    // Windows' programs write "1.#INF", "-1.#IND" and "1.#QNAN".
    if (const std::size_t mark = digits.find(".#"); mark != digits.npos) {
        const std::string_view kind = digits.substr(mark + 2);
        const double infinity = std::numeric_limits<double>::infinity();
        if (kind.starts_with("INF")) return digits.starts_with('-') ? -infinity : infinity;
        if (kind.starts_with("IND") || kind.starts_with("QNAN") || kind.starts_with("SNAN"))
            return std::numeric_limits<double>::quiet_NaN();
    }
    fail(word.empty() ? "line ends, expected a number" : quoted(word) + ", expected a number");
}

long long TextScanner::integer(std::string_view word) const {
    const std::string_view digits = withoutPlus(word);
    long long value = 0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (stop == digits.data() + digits.size() && !digits.empty()) {
        if (error == std::errc{}) return value;
        if (error == std::errc::result_out_of_range) return std::numeric_limits<long long>::max();
    }
    fail(word.empty() ? "line ends, expected a whole number"
                      : quoted(word) + ", expected a whole number");
}

void TextScanner::fail(const std::string& cause) const {
    throwFileError(path_, fmt::format("line {}: {}", line_, cause));
}

}  // namespace shadowcache
