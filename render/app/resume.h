#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "common/image/exr.h"
#include "common/image/image.h"

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

/// Size and time of change of the files, as one number for the metadata.
std::string inputsMark(std::span<const std::filesystem::path> files);

}  // namespace shadowcache
