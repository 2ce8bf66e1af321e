#include "common/base/option_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>

#include "common/base/error.h"
#include "common/base/take_text.h"
#include "common/base/text_streams.h"

namespace shadowcache {

void refuseText(const std::string& name, const std::string& text, const std::string& wanted) {
    throw Error("--" + name + " " + text + ": expected " + wanted);
}

std::vector<double> numbersOf(const std::string& name, const std::string& text,
                              const std::vector<std::size_t>& counts, const std::string& wanted) {
    std::vector<double> numbers;
    TextReader parts(text);
    std::string part;
    while (std::getline(parts, part, ',')) {
        double number = 0;
        TextReader field(part);
        if (!(field >> number) || !field.eof() || !std::isfinite(number)) break;
        numbers.push_back(number);
    }
    if (std::ranges::find(counts, numbers.size()) == counts.end() || !parts.eof())
        refuseText(name, text, wanted);
    return numbers;
}

std::array<int, 2> pairOf(const std::string& name, const std::string& text,
                          const std::string& wanted) {
    std::array<int, 2> pair{};
    std::string_view rest = text;
    if (takeNumber(rest, pair[0]) && (takeCharacter(rest, 'x') || takeCharacter(rest, ',')) &&
        takeNumber(rest, pair[1]) && rest.empty() && pair[0] >= 0 && pair[1] >= 0)
        return pair;
    refuseText(name, text, wanted);
}

std::uint64_t bytesOf(const std::string& name, const std::string& text) {
    double bytes = 0;
    const char* const end = text.data() + text.size();
    const char* const unit = std::from_chars(text.data(), end, bytes, std::chars_format::fixed).ptr;
    std::string rest(unit, end);
    std::ranges::transform(rest, rest.begin(), [](unsigned char c) { return std::toupper(c); });
    const std::string units = "KMGT";
    const std::size_t power = rest.empty() ? units.npos : units.find(rest[0]);
    if (power != units.npos) {
        bytes *= std::pow(1024.0, static_cast<double>(power + 1));
        rest.erase(0, 1);
    }
    if (!(bytes >= 1 && bytes <= 0x1p62) || (rest != "" && rest != "B" && rest != "IB"))
        refuseText(name, text, "a size in bytes, as in 4G, 1.5G or 512M");
    return static_cast<std::uint64_t>(bytes);
}

}  // namespace shadowcache
