#include "common/shot/frames.h"

#include <cstdio>
#include <regex>
#include <set>

#include "common/base/error.h"
#include "common/base/text_streams.h"

namespace shadowcache {

namespace {

/// Where the frame's number goes in the name of a file.
struct NumberPlace {
    std::size_t at = 0, length = 0;  ///< bytes; length 0: nowhere
    int digits = 1;                  ///< at least
};

/// The last run of '#', or %d, %4d or %04d.
NumberPlace numberPlace(const std::string& name) {
    static const std::regex printfStyle(R"(%0?(\d?)d)");
    NumberPlace place;
    std::smatch match;
    if (const std::size_t last = name.rfind('#'); last != std::string::npos) {
        const std::size_t before = name.find_last_not_of('#', last);
        place.at = before == std::string::npos ? 0 : before + 1;
        place.length = last + 1 - place.at;
        place.digits = static_cast<int>(place.length);
    } else if (std::regex_search(name, match, printfStyle)) {
        place.at = static_cast<std::size_t>(match.position(0));
        place.length = static_cast<std::size_t>(match.length(0));
        if (match[1].length() > 0) place.digits = std::stoi(match[1]);
    }
    return place;
}

}  // namespace

std::vector<int> parseFrames(const std::string& text, const std::string& option) {
    static const std::regex range(R"((-?\d{1,7})(?:-(-?\d{1,7})(?:x(\d{1,7}))?)?)");
    std::vector<int> frames;
    std::set<int> seen;
    TextReader parts(text);
    std::string part;
    while (std::getline(parts, part, ',')) {
        std::smatch match;
        const bool matched = std::regex_match(part, match, range);
        const int first = matched ? std::stoi(match[1]) : 0;
        const int last = matched && match[2].matched ? std::stoi(match[2]) : first;
        const int step = matched && match[3].matched ? std::stoi(match[3]) : 1;
        if (!matched || last < first || step < 1)
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
    std::snprintf(number, sizeof number, "%.*d", place.digits, frame);
    return pattern.parent_path() / name.replace(place.at, place.length, number);
}

}  // namespace shadowcache
