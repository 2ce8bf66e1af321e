#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "common/image/exr.h"
#include "common/image/image.h"
#include "common/import/references.h"

namespace shadowcache {

/// What --resume finds of a frame.
enum class FrameState {
    missing,
    broken,   ///< not a whole EXR file
    changed,  ///< of other settings or inputs
    done
};

/// Compares a frame's file with the metadata it would get; what does not concern the picture (time,
/// threads, where it is written) is left out.
///
/// @param width, height  of the pixels that the file has, > 0
FrameState frameState(const std::filesystem::path& path, const Metadata& metadata, int width,
                      int height);

/// Content of the files that pictures depend on. Each file is read once, whatever the number of
/// frames; a copy under another name and date is the same file.
class InputHashes {
public:
    /// @param references  which files of glTF sets count
    explicit InputHashes(References references) : references_(references) {}

    /// One hash of all files, in their order, with the buffers and images that glTF files refer to.
    ///
    /// @throws Error naming a file that cannot be read
    std::string of(std::span<const std::filesystem::path> files);

private:
    References references_;
    std::map<std::filesystem::path, std::string> known_;
};

}  // namespace shadowcache
