#include "common/base/suggestion.h"

#include <algorithm>
#include <vector>

namespace shadowcache {

namespace {

/// Fewest letters to insert, drop, change or swap with a neighbour. [Damerau 1964, restricted]
std::size_t distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i)
        for (std::size_t j = 1; j <= b.size(); ++j) {
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1,
                                d[i - 1][j - 1] + static_cast<std::size_t>(a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[a.size()][b.size()];
}

}  // namespace

std::string nearestWord(const std::string& typed, std::span<const std::string> known) {
    std::string best;
    constexpr std::size_t kLongestWord = 64;
    if (typed.size() > kLongestWord) return best;
    // Further away than a third of its letters, a word is another one; a beginning is near.
    std::size_t least = std::max<std::size_t>(1, typed.size() / 3) + 1;
    for (const std::string& word : known) {
        const bool begun = typed.size() >= 3 && word.starts_with(typed);
        const std::size_t d = begun ? 1 : distance(typed, word);
        if (d < least) {
            least = d;
            best = word;
        }
    }
    return best;
}

std::string suggestion(const std::string& typed, std::span<const std::string> known) {
    const std::string word = nearestWord(typed, known);
    return word.empty() ? "" : ", did you mean " + word + "?";
}

}  // namespace shadowcache
