#include "common/image/hdr_header.h"

#include <fmt/core.h>

#include <cmath>
#include <string_view>

#include "common/base/error.h"
#include "common/base/file_bytes.h"

namespace shadowcache {

namespace {

constexpr std::string_view kFormat = "32-bit_rle_rgbe";
constexpr long long kMostSide = 1 << 24;
constexpr double kMostChromaticity = 100;

/// Lines of a text that end with LF or CR LF.
class Lines {
public:
    Lines(const std::filesystem::path& path, std::string_view text) : path_(path), text_(text) {}

    std::string_view next() {
        const std::size_t end = text_.find('\n', at_);
        if (end == text_.npos) throwFileError(path_, "truncated: ends within the HDR header");
        std::string_view line = text_.substr(at_, end - at_);
        if (line.ends_with('\r')) line.remove_suffix(1);
        at_ = end + 1;
        ++number_;
        return line;
    }
    /// The words of the last line, behind its first `skipped` bytes.
    TextScanner scan(std::string_view line, std::size_t skipped) const {
        return {path_, line.substr(skipped), false, number_};
    }
    std::size_t bytes() const { return at_; }

private:
    const std::filesystem::path& path_;
    std::string_view text_;
    std::size_t at_ = 0;
    std::size_t number_ = 0;
};

/// Multiplies by the numbers of an EXPOSURE (one) or COLORCORR (three) line.
void multiply(TextScanner text, const std::string& name, bool eachColor, HdrHeader& header) {
    double value = 0;
    for (std::size_t k = 0; k < header.multiplier.size(); ++k) {
        if (k == 0 || eachColor) value = text.number(text.wordOnLine());
        double& product = header.multiplier[k];
        product *= value;
        if (!(value > 0 && product > 0 && std::isfinite(product)))
            text.fail(fmt::format(
                "{} of {:f}, expected above 0 and finite, with those before it too", name, value));
    }
}

std::array<float, 8> primariesOf(TextScanner text) {
    std::array<float, 8> found{};
    for (float& number : found) {
        const double value = text.number(text.wordOnLine());
        if (!(std::abs(value) <= kMostChromaticity))
            text.fail(fmt::format("PRIMARIES with {:g}, expected numbers up to {:g}", value,
                                  kMostChromaticity));
        number = static_cast<float>(value);
    }
    return found;
}

/// A line of the header; what other programs say of themselves begins otherwise.
void parseLine(const Lines& lines, std::string_view line, HdrHeader& header, bool& hasFormat) {
    constexpr std::string_view kFormatName = "FORMAT=", kExposureName = "EXPOSURE=",
                               kColorName = "COLORCORR=", kPrimariesName = "PRIMARIES=",
                               kGammaName = "GAMMA=";
    if (line.starts_with(kFormatName)) {
        TextScanner text = lines.scan(line, kFormatName.size());
        const std::string_view format = text.wordOnLine();
        hasFormat = format == kFormat;
        if (hasFormat) return;
        text.fail("FORMAT=" + std::string(format.substr(0, 30)) +
                  (format == "32-bit_rle_xyze" ? " (CIE XYZ)" : "") +
                  ", expected FORMAT=" + std::string(kFormat));
    } else if (line.starts_with(kExposureName)) {
        multiply(lines.scan(line, kExposureName.size()), "EXPOSURE", false, header);
    } else if (line.starts_with(kColorName)) {
        multiply(lines.scan(line, kColorName.size()), "COLORCORR", true, header);
    } else if (line.starts_with(kPrimariesName)) {
        header.primaries = primariesOf(lines.scan(line, kPrimariesName.size()));
    } else if (line.starts_with(kGammaName)) {
        TextScanner text = lines.scan(line, kGammaName.size());
        header.gamma = text.number(text.wordOnLine());
    }
}

/// "-Y HEIGHT +X WIDTH", either axis first, each with either sign. The first is that of scan lines.
void parseResolution(TextScanner text, HdrHeader& header) {
    for (int axis = 0; axis < 2; ++axis) {
        const std::string_view name = text.wordOnLine();
        const bool isX = name == "+X" || name == "-X", isY = name == "+Y" || name == "-Y";
        if ((!isX && !isY) || (isX ? header.width : header.height) > 0)
            text.fail("resolution axis '" + std::string(name.substr(0, 20)) +
                      "', expected one of +X and -X, and one of +Y and -Y");
        const long long size = text.integer(text.wordOnLine());
        if (size < 1 || size > kMostSide)
            text.fail(fmt::format("side of {} pixels, expected 1 to {}", size, kMostSide));
        (isX ? header.width : header.height) = static_cast<std::size_t>(size);
        if (axis == 0) header.byColumns = isX;
        // +Y points up.
        if (name == "-X") header.fromRight = true;
        if (name == "+Y") header.fromBottom = true;
    }
}

}  // namespace

HdrHeader parseHdrHeader(const std::filesystem::path& path, const std::string& content) {
    HdrHeader header;
    Lines lines(path, content);
    std::string_view line = lines.next();
    if (!line.starts_with("#?")) throwFileError(path, "does not start with '#?', expected HDR");
    bool hasFormat = false;
    for (line = lines.next(); !line.empty(); line = lines.next())
        parseLine(lines, line, header, hasFormat);
    if (!hasFormat)
        lines.scan(line, 0).fail("no FORMAT before, expected FORMAT=" + std::string(kFormat));
    line = lines.next();
    parseResolution(lines.scan(line, 0), header);
    header.bytes = lines.bytes();
    return header;
}

}  // namespace shadowcache
