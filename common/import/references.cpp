#include "common/import/references.h"

#include <algorithm>
#include <cctype>

#include "common/base/error.h"

namespace shadowcache {

namespace fs = std::filesystem;

bool isBeside(const fs::path& set, const fs::path& file) {
    std::error_code error;
    const fs::path absolute = fs::absolute(set, error).parent_path();
    const fs::path folder = error ? fs::path() : fs::weakly_canonical(absolute, error);
    const fs::path target = error ? fs::path() : fs::weakly_canonical(file, error);
    if (error || folder.empty()) return false;
    const auto end = std::mismatch(folder.begin(), folder.end(), target.begin(), target.end());
    return end.first == folder.end();
}

fs::path referencedFile(const fs::path& set, const std::string& uri) {
    return set.parent_path() / uri;
}

std::string decodedUri(const std::string& uri) {
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const auto digit = [&](std::size_t at) {
            return std::isxdigit(static_cast<unsigned char>(uri[at])) != 0;
        };
        if (uri[i] == '%' && i + 2 < uri.size() && digit(i + 1) && digit(i + 2)) {
            text += static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16));
            i += 2;
        } else {
            text += uri[i];
        }
    }
    return text;
}

std::optional<fs::path> namedFile(const fs::path& set, const fs::path& base,
                                  const std::string& name, References references) {
    std::string slashed = name;
    std::ranges::replace(slashed, '\\', '/');
    std::error_code ignored;
    const bool quoted = slashed.size() > 2 && slashed.starts_with('"') && slashed.ends_with('"');
    const std::string bare = quoted ? slashed.substr(1, slashed.size() - 2) : "";
    for (const std::string& spelling : {name, slashed, bare}) {
        const fs::path file = referencedFile(base, spelling);
        if (spelling.empty() || !fs::is_regular_file(file, ignored)) continue;
        if (references == References::inside && !isBeside(set, file))
            throwFileError(set, "names " + file.string() +
                                    ", which is outside of its folder: expected a file beside it, "
                                    "or --allow-external");
        return file;
    }
    return {};
}

}  // namespace shadowcache
