#include "common/import/mtl_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "common/base/error.h"
#include "common/base/file_bytes.h"

namespace shadowcache {

namespace {

/// Colours beyond that have no meaning, and their square no room.
constexpr double kMostColor = 1e15;
/// Of normal maps; more is no surface.
constexpr double kMostStrength = 1e6;

std::string lowerCase(std::string_view word) {
    std::string lower(word);
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return lower;
}

/// A name for the report: it may be long and hold anything.
std::string printableWord(std::string_view word) {
    constexpr std::size_t kMostBytes = 60;
    std::string text;
    for (const char c : word.substr(0, kMostBytes))
        text += std::iscntrl(static_cast<unsigned char>(c)) ? '?' : c;
    return text;
}

/// Lines that have no part in a picture of direct light, or that others make complete: colours and
/// maps of ambient light, and the index of refraction, which goes with Tf and illum.
constexpr std::array<std::string_view, 6> kMeaningless{"ka",      "map_ka", "ni",
                                                       "map_aat", "pcr",    "anisor"};
/// Amounts of which 0 is none.
constexpr std::array<std::string_view, 3> kAmounts{"ps", "pc", "aniso"};

template <std::size_t N>
bool isOneOf(const std::array<std::string_view, N>& words, std::string_view word) {
    return std::ranges::find(words, word) != words.end();
}

class Parser {
public:
    Parser(const std::filesystem::path& path, std::string_view bytes) : text_(path, bytes, true) {}

    /// A line that cannot be read is left out by its name.
    std::vector<MtlMaterial> run() {
        constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
        for (; !text_.atEnd(); text_.nextLine()) {
            std::string_view word = text_.wordOnLine();
            if (materials_.empty() && word.starts_with(kByteOrderMark))
                word.remove_prefix(kByteOrderMark.size());
            if (word.empty()) continue;
            const std::string key = lowerCase(word);
            if (key == "newmtl") {
                materials_.emplace_back().name = text_.restOfLine();
                continue;
            }
            if (materials_.empty()) {
                early_.push_back(printableWord(word) + " (before newmtl)");
                continue;
            }
            try {
                readLine(key, word);
            } catch (const Error&) {
                leaveOut(std::string(word) + " (not as expected)");
            }
            if (!refusal_.empty()) text_.fail(refusal_);
        }
        for (MtlMaterial& m : materials_) finish(m);
        if (!materials_.empty())
            for (const std::string& line : early_) materials_.front().leaveOut(line);
        return std::move(materials_);
    }

private:
    MtlMaterial& material() { return materials_.back(); }

    void leaveOut(std::string_view what) { material().leaveOut(printableWord(what)); }

    /// Tr 1 alone is what MeshLab before 2023, openMVS and mvs-texturing write for opaque.
    void finish(MtlMaterial& m) const {
        if (!m.transparency) return;
        if (!m.opacity && *m.transparency == 1) {
            m.leaveOut("Tr 1 (without d beside it: taken for opaque)");
            return;
        }
        // Programs that write both write Tr the other way round at times.
        if (!m.opacity) m.opacity = 1 - *m.transparency;
    }

    void readLine(const std::string& key, std::string_view word) {
        MtlMaterial& m = material();
        if (key == "kd") {
            readColor(word, m.diffuse);
        } else if (key == "ks") {
            readColor(word, m.specular);
        } else if (key == "ke") {
            readEmission(word);
        } else if (key == "d") {
            readOpacity();
        } else if (key == "tr") {
            m.transparency = readShare();
        } else if (key == "ns") {
            m.exponent = bounded(text_.number(text_.wordOnLine()), 1e6);
        } else if (key == "pr") {
            m.roughness = readShare();
        } else if (key == "pm") {
            m.metallic = readShare();
        } else if (key == "illum") {
            readIllumination();
        } else if (key == "tf") {
            readFilter(word);
        } else if (isOneOf(kMtlMaps, key)) {
            readMap(key, word);
        } else if (isOneOf(kAmounts, key)) {
            if (text_.number(text_.wordOnLine()) != 0) leaveOut(word);
        } else if (!isOneOf(kMeaningless, key)) {
            leaveOut(word);
        }
    }

    float bounded(double x, double most) {
        const double within = std::isfinite(x) ? std::clamp(x, 0.0, most) : 0.0;
        material().clamped = material().clamped || within != x;
        return static_cast<float>(within);
    }

    float readShare() { return bounded(text_.number(text_.wordOnLine()), 1); }

    /// "r g b", or "r" for a grey; colours given as spectra or in XYZ are left out.
    std::optional<Vec3d> colorOnLine(std::string_view keyword) {
        const std::string_view first = text_.wordOnLine();
        if (first == "spectral" || first == "xyz") {
            leaveOut(std::string(keyword) + " " + std::string(first));
            return {};
        }
        const double r = text_.number(first);
        const std::string_view second = text_.wordOnLine();
        const double g = second.empty() ? r : text_.number(second);
        return Vec3d(r, g, second.empty() ? r : text_.number(text_.wordOnLine()));
    }

    void readColor(std::string_view keyword, std::optional<Rgb>& to) {
        if (const std::optional<Vec3d> c = colorOnLine(keyword))
            to = Rgb(bounded(c->x, kMostColor), bounded(c->y, kMostColor),
                     bounded(c->z, kMostColor));
    }

    /// Light that is less than none, or endless, is refused.
    void readEmission(std::string_view keyword) {
        const std::optional<Vec3d> c = colorOnLine(keyword);
        if (!c) return;
        for (int k = 0; k < 3; ++k)
            if (!((*c)[k] >= 0 && (*c)[k] <= kMostColor))
                refusal_ = fmt::format("material {}: {} {:g} {:g} {:g}, expected 0 to {:g}",
                                       printableWord(material().name), keyword, c->x, c->y, c->z,
                                       kMostColor);
        material().emission = Rgb(*c);
    }

    void readOpacity() {
        const std::string_view first = text_.wordOnLine();
        if (first == "-halo") return leaveOut("d -halo");
        material().opacity = bounded(text_.number(first), 1);
    }

    /// The kinds of glass: 4, 6, 7 and 9.
    void readIllumination() {
        const double number = text_.number(text_.wordOnLine());
        if (!(number >= 0 && number <= 100)) return leaveOut("illum (not as expected)");
        const int kind = static_cast<int>(std::lround(number));
        material().illumination = kind;
        if (kind == 4 || kind == 6 || kind == 7 || kind == 9)
            leaveOut(fmt::format("refraction (illum {})", kind));
        if (kind == 0) leaveOut("constant colour (illum 0)");
        if (kind == 10) leaveOut("being but its shadow (illum 10)");
    }

    /// Tf of 1 filters nothing.
    void readFilter(std::string_view keyword) {
        for (std::string_view word = text_.wordOnLine(); !word.empty(); word = text_.wordOnLine())
            if (word == "spectral" || word == "xyz" || text_.number(word) != 1)
                return leaveOut(keyword);
    }

    /// Options, each with its numbers, then the file's name, which is the rest of the line.
    void readMap(const std::string& key, std::string_view keyword) {
        MtlMap map;
        for (;;) {
            const TextScanner before = text_;
            const std::string option = lowerCase(text_.wordOnLine());
            if (option == "-s") {
                if (!readPair(map.scale, 1)) leaveOut(std::string(keyword) + " -s (out of range)");
            } else if (option == "-o") {
                if (!readPair(map.offset, 0)) leaveOut(std::string(keyword) + " -o (out of range)");
            } else if (option == "-clamp") {
                map.clamp = lowerCase(text_.wordOnLine()) == "on";
            } else if (option == "-bm" && key == "norm") {
                const double strength = text_.number(text_.wordOnLine());
                map.strength =
                    std::abs(strength) < kMostStrength ? static_cast<float>(strength) : 1;
            } else if (const auto skipped = skipOption(option)) {
                if (*skipped) leaveOut(std::string(keyword) + " " + option);
            } else {
                text_ = before;
                break;
            }
        }
        map.file = text_.restOfLine();
        if (map.file.empty()) return leaveOut(std::string(keyword) + " (without a file's name)");
        material().maps[key] = std::move(map);
    }

    /// One to three numbers; those that are not there are `fallback`, and the third is not used.
    ///
    /// @return whether they are in range; others are `fallback`
    bool readPair(std::array<float, 2>& to, float fallback) {
        to = {fallback, fallback};
        bool inRange = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const TextScanner before = text_;
            const std::string_view word = text_.wordOnLine();
            if (!isNumber(word)) {
                text_ = before;
                break;
            }
            const double value = text_.number(word);
            const bool fits = std::abs(value) < 1e6;
            inRange = inRange && (fits || k == 2);
            if (k < 2) to[k] = fits ? static_cast<float>(value) : fallback;
        }
        return inRange;
    }

    static bool isNumber(std::string_view word) {
        return word.find_first_of("0123456789") != word.npos &&
               word.find_first_not_of("+-.0123456789eE") == word.npos;
    }

    /// Of the options that are not read: whether something is lost, which it is not by those that
    /// stand at their defaults or are of a picture's filter. Nothing if it is no option.
    std::optional<bool> skipOption(const std::string& option) {
        if (option == "-mm" || option == "-t") {
            std::array<float, 2> found{};
            const bool inRange = readPair(found, 0);
            return !inRange ||
                   found != (option == "-t" ? std::array<float, 2>{} : std::array<float, 2>{0, 1});
        }
        constexpr std::array<std::string_view, 3> kOfFilters{"-blendu", "-blendv", "-texres"};
        constexpr std::array<std::string_view, 5> kWithOneWord{"-bm", "-boost", "-cc", "-imfchan",
                                                               "-type"};
        if (!isOneOf(kOfFilters, option) && !isOneOf(kWithOneWord, option)) return {};
        const std::string value = lowerCase(text_.wordOnLine());
        if (isOneOf(kOfFilters, option)) return false;
        const bool isNone = option == "-cc" ? value == "off"
                                            : isNumber(value) && text_.number(value) ==
                                                                     (option == "-bm" ? 1.0 : 0.0);
        return !isNone;
    }

    TextScanner text_;
    std::string refusal_;  ///< of a line that must not be left out
    std::vector<MtlMaterial> materials_;
    std::vector<std::string> early_;  ///< lines before the first material
};

}  // namespace

void MtlMaterial::leaveOut(const std::string& line) {
    if (std::ranges::find(leftOut, line) == leftOut.end()) leftOut.push_back(line);
}

const MtlMap* MtlMaterial::map(std::string_view keyword) const {
    const auto found = maps.find(keyword);
    return found == maps.end() ? nullptr : &found->second;
}

std::vector<MtlMaterial> readMtl(const std::filesystem::path& path) {
    std::error_code ignored;
    if (std::filesystem::file_size(path, ignored) == 0) return {};
    std::string bytes = readFileBytes(path);
    useLineFeeds(bytes);
    if (bytes.find('\0') != bytes.npos)
        throwFileError(path, "holds binary data, expected a library of materials");
    return Parser(path, bytes).run();
}

}  // namespace shadowcache
