#include "common/shot/frames.h"

#include <cstdio>
#include <cstdlib>
#include <set>
#include <string_view>

#include "common/base/error.h"
#include "common/base/take_text.h"
#include "common/base/text_streams.h"

namespace shadowcache {

namespace {

/// Where the frame's number goes in the name of a file.
struct NumberPlace {
    std::size_t at = 0, length = 0;  ///< bytes; length 0: nowhere
    int digits = 1;                  ///< at least
    bool signedWidth = false;        ///< a sign is one of them, as printf() counts
};

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

/// The last run of '#', or %d, %4d or %04d.
NumberPlace numberPlace(const std::string& name) {
    NumberPlace place;
    if (const std::size_t last = name.rfind('#'); last != std::string::npos) {
        const std::size_t before = name.find_last_not_of('#', last);
        place.at = before == std::string::npos ? 0 : before + 1;
        place.length = last + 1 - place.at;
        place.digits = static_cast<int>(place.length);
        return place;
    }
    for (std::size_t at = name.find('%'); at != std::string::npos; at = name.find('%', at + 1)) {
        std::string_view rest = std::string_view(name).substr(at + 1);
        takeCharacter(rest, '0');
        const int digits = !rest.empty() && isDigit(rest[0]) ? rest[0] - '0' : -1;
        if (digits >= 0) rest.remove_prefix(1);
        if (!takeCharacter(rest, 'd')) continue;
        place.at = at;
        place.length = name.size() - rest.size() - at;
        if (digits >= 0) place.digits = digits;
        place.signedWidth = true;
        break;
    }
    return place;
}

/// A number of at most seven digits.
bool takeFrame(std::string_view& text, int& frame) {
    return takeNumber(text, frame) && std::abs(frame) < 10'000'000;
}

}  // namespace

bool hasFrameNumber(const std::string& name) {
    return numberPlace(name).length > 0;
}

std::vector<int> parseFrames(const std::string& text, const std::string& option) {
    std::vector<int> frames;
    std::set<int> seen;
    TextReader parts(text);
    std::string part;
    while (std::getline(parts, part, ',')) {
        std::string_view rest = part;
        int first = 0, step = 1;
        bool read = takeFrame(rest, first);
        int last = first;
        if (read && takeCharacter(rest, '-')) {
            read = takeFrame(rest, last);
            if (takeCharacter(rest, 'x')) read &= takeFrame(rest, step);
        }
        if (!read || !rest.empty() || last < first || step < 1)
            throw Error(option + " " + text +
                        ": expected A, A-B or A-BxSTEP with A <= B, several joined by commas");
        for (int f = first; f <= last; f += step)
            if (seen.insert(f).second) frames.push_back(f);
    }
    if (frames.empty()) throw Error(option + ": empty, expected A, A-B or A-BxSTEP");
    return frames;
}

std::filesystem::path framePath(const std::filesystem::path& pattern, int frame, FrameNames names) {
    std::string name = pattern.filename().string();
    const NumberPlace place = numberPlace(name);
    if (place.length == 0 || (names == FrameNames::unasked && place.digits == 1)) {
        if (names == FrameNames::several)
            throw Error(
                "--output " + pattern.string() +
                ": several frames, expected a frame number in the name, as in frame.####.exr");
        return pattern;
    }
    char number[32];
    std::snprintf(number, sizeof number, place.signedWidth ? "%0*d" : "%.*d", place.digits, frame);
    return pattern.parent_path() / name.replace(place.at, place.length, number);
}

}  // namespace shadowcache
