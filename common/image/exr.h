#pragma once

#include <algorithm>
#include <filesystem>
#include <string>

#include "common/base/error.h"
#include "common/image/image.h"

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

/// The OpenEXR part of readRadiance; texels are as in the file, not mended.
RadianceImage readExrRadiance(const std::filesystem::path& path);

}  // namespace shadowcache
