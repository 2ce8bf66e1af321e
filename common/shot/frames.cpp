#include "common/shot/frames.h"

#include <cstdio>
#include <regex>
#include <set>

#include "common/base/error.h"
#include "common/base/text_streams.h"

namespace shadowcache {

std::vector<int> parseFrames(const std::string& text, const std::string& option) {
    static const std::regex range(R"((\d{1,7})(?:-(\d{1,7})(?:x(\d{1,7}))?)?)");
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

std::filesystem::path framePath(const std::filesystem::path& pattern, int frame, bool several) {
    std::string name = pattern.filename().string();
    static const std::regex printfStyle(R"(%0?(\d?)d)");
    std::smatch match;
    std::size_t at = name.find('#'), length = 0;
    int width = 0;
    if (at != std::string::npos) {
        while (at + length < name.size() && name[at + length] == '#') ++length;
        width = static_cast<int>(length);
    } else if (std::regex_search(name, match, printfStyle)) {
        at = static_cast<std::size_t>(match.position(0));
        length = static_cast<std::size_t>(match.length(0));
        width = match[1].length() ? std::stoi(match[1]) : 1;
    } else {
        if (several)
            throw Error(
                "--output " + pattern.string() +
                ": several frames, expected a frame number in the name, as in frame.####.exr");
        return pattern;
    }
    char number[32];
    std::snprintf(number, sizeof number, "%0*d", width, frame);
    return pattern.parent_path() / name.replace(at, length, number);
}

}  // namespace shadowcache
