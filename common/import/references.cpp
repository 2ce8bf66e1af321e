#include "common/import/references.h"

#include <algorithm>

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

}  // namespace shadowcache
