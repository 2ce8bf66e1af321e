#pragma once

// Private to the cache's .cpp files: names types of OpenVDB. This is where values lie in a file;
// what they are and of which types stands in cache_schema.h, and cache_writer.cpp writes them.

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>

#include <array>
#include <filesystem>
#include <istream>
#include <span>
#include <vector>

#include "common/cache/budgeted_pages.h"
#include "common/cache/cache_schema.h"

namespace shadowcache {

/// Most attributes of one grid that a reader may want.
inline constexpr std::size_t kMostArrays = kItemAttributes;
static_assert(kMostArrays >= kBlockAttributes);

/// Where the values of a leaf's attribute lie: `offset` bytes behind the start of an unpacked page.
struct ArrayPlace {
    std::uint32_t page;
    std::uint32_t offset : 31;
    std::uint32_t uniform : 1;  ///< one value stands for all
};

/// Where the arrays of a leaf lie.
struct LeafPlace {
    openvdb::Coord origin;                       ///< its first voxel
    std::uint32_t points;                        ///< number of points
    ArrayPlace voxelEnds;                        ///< kLeafVoxels offsets of four bytes
    std::array<ArrayPlace, kMostArrays> arrays;  ///< of the attributes that were asked for
};

/// Where everything of a point grid lies in its file, leaf by leaf in the file's order.
using PointLayout = std::vector<LeafPlace>;

/// Finds the parts of point grids in an OpenVDB file without reading them. OpenVDB can read them on
/// demand, but cannot drop them again.
class PointLayoutReader final : openvdb::io::Archive {
public:
    /// @param file  stays as long as this
    /// @throws Error naming the file and the cause
    explicit PointLayoutReader(const CheckedFile& file);

    /// Where the attributes `wanted` of a grid are; their pages are appended to `pages`.
    ///
    /// @throws Error also where the grid is laid out otherwise than OpenVDB 10 does with Blosc
    PointLayout read(const char* grid, std::span<const AttributeSpec> wanted,
                     std::vector<FilePage>& pages);

private:
    struct Pass;

    std::filesystem::path path_;
    openvdb::SharedPtr<openvdb::io::StreamMetadata> streamMetadata_;  ///< in_ keeps its address
    CheckedBuffer buffer_;
    std::istream in_;
    std::vector<openvdb::io::GridDescriptor> grids_;

    template <class T>
    T number();
    [[noreturn]] void failLayout(const char* cause) const;
    const openvdb::io::GridDescriptor& find(const char* grid) const;
    PointLayout readTopology(const openvdb::io::GridDescriptor& grid);
    void readSizes(Pass& pass, std::span<const AttributeSpec> wanted);
    void readPageTable(Pass& pass, std::size_t attribute);
    void placeVoxelEnds(Pass& pass);
};

}  // namespace shadowcache
