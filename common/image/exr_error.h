#pragma once

// Private to the files that see OpenEXR.

#include <algorithm>
#include <filesystem>
#include <string>

#include "common/base/error.h"

namespace shadowcache {

/// Runs `action`; a failure of OpenEXR becomes an Error of one line.
template <class Action>
auto translated(const std::filesystem::path& path, const Action& action) {
    try {
        return action();
    } catch (const Error&) {
        throw;
    } catch (const std::exception& e) {
        std::string text = e.what();
        std::replace(text.begin(), text.end(), '\n', ' ');
        throwFileError(path, text);
    }
}

}  // namespace shadowcache
