#pragma once

#include <deque>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/import/gltf_object.h"
#include "common/import/references.h"

namespace shadowcache {

/// The JSON of a .gltf or .glb file's bytes.
std::string_view gltfJson(std::string_view bytes);

/// The file that a glTF file names by a URI, whose escapes are replaced if that finds it.
///
/// @return nothing if there is no such regular file, or the URI holds its data itself
/// @throws Error as namedFile()
std::optional<std::filesystem::path> gltfNeighbour(const std::filesystem::path& path,
                                                   const std::string& uri, References references);

/// A .gltf file with its buffers, or a .glb.
class GltfFile {
public:
    /// @throws Error naming the file and the cause: missing, truncated, foreign, an extension that
    /// is required and unknown here, a file outside of its folder that it may not name
    GltfFile(const std::filesystem::path& path, References references);

    /// Whether its texts are not UTF-8: bytes that are none are replaced.
    bool isMended() const { return isMended_; }

    GltfObject root() const { return {path_, json_, ""}; }

    /// Bytes of a buffer view, decoded if they are compressed (EXT_meshopt_compression).
    ///
    /// @param view  in the file's list
    std::string_view view(const GltfObject& user, int view);
    /// Bytes from one of a view's elements to the next; 0: the view has none.
    std::size_t stride(int view) const;
    std::size_t viewCount() const { return views_.size(); }

    /// Of all buffers [bytes].
    std::size_t size() const { return size_; }

    /// Bytes of a picture, and what messages call it; none if its file is missing.
    std::string_view picture(int image, std::string& name);
    std::size_t pictureCount() const { return images_.size(); }

    /// Keeps bytes that a part of the file became.
    ///
    /// @throws Error if all of them are too many for a file of its size
    std::string_view keep(const GltfObject& user, std::string bytes);

    /// All bytes: what views and pictures look into. The file has none from now on.
    std::deque<std::string> takeStorage() { return std::move(storage_); }

private:
    struct View {
        std::string_view bytes;
        std::size_t stride = 0;
    };

    void readBuffers(std::string_view chunk);
    std::string bufferBytes(const GltfObject& buffer, std::string_view chunk, bool isFirst) const;
    std::string_view within(const GltfObject& view) const;
    std::string decoded(const GltfObject& extension) const;

    const std::filesystem::path& path_;
    References references_;
    nlohmann::json json_;
    bool isMended_ = false;
    std::vector<GltfObject> views_, images_;
    std::vector<std::optional<View>> known_;  ///< by view
    std::deque<std::string> storage_;         ///< the buffers first
    std::size_t buffers_ = 0, size_ = 0;
    double room_ = 0;  ///< [bytes] that may still be decoded
};

}  // namespace shadowcache
