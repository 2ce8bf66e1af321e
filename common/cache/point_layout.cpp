// A point grid in an OpenVDB file (file format 224): metadata, transform and topology, then several
// passes over the leaves. With A attributes:
//   pass 0             packed length of each leaf's voxel ends
//   pass 1             the attributes' names and types, once; size of each array of each leaf
//   passes 2 .. A + 1  sizes of the pages of one attribute, met by the leaves as they fill them
//   pass A + 2         voxel ends of each leaf
//   the next A         the pages of one attribute
// An array of a leaf never goes over the end of a page. OpenVDB's own reader for comparison:
// PointDataLeafNode::readBuffers, TypedAttributeArray::readMetadata, PagedInputStream.

#include "common/cache/point_layout.h"

#include <openvdb/io/io.h>

#include <limits>
#include <new>

#include "common/base/error.h"
#include "common/cache/leaf_view.h"

namespace shadowcache {

namespace {

using openvdb::points::AttributeSet;

/// TypedAttributeArray::SerializationFlag keeps these to its class.
constexpr std::uint8_t kStrided = 1, kUniform = 2, kPaged = 8;

/// Leaves whose voxel ends make a page: a megabyte, as the other pages have.
constexpr std::size_t kVoxelEndLeaves = 512;

constexpr std::uint64_t kMostPageBytes = std::uint64_t{1} << 30;

}  // namespace

/// What the passes over the leaves of one grid leave to each other.
struct PointLayoutReader::Pass {
    PointLayout leaves;
    std::vector<FilePage>& pages;
    std::size_t attributes = 0;
    std::vector<std::uint16_t> voxelEndLengths;  ///< by leaf
    std::vector<std::uint32_t> bytes;            ///< by leaf and attribute
    /// Of each attribute, the page of its first and one behind its last.
    std::vector<std::array<std::size_t, 2>> runs{};
    std::vector<std::size_t> wantedIndex{};  ///< by attribute: in LeafPlace::arrays, or kMostArrays
};

PointLayoutReader::PointLayoutReader(const CheckedFile& file)
    : path_(file.path()), buffer_(file), in_(&buffer_) {
    in_.exceptions(std::ios::failbit | std::ios::badbit);
    try {
        streamMetadata_.reset(new openvdb::io::StreamMetadata);
        streamMetadata_->setSeekable(true);
        openvdb::io::setStreamMetadataPtr(in_, streamMetadata_, /*transfer=*/false);
        readHeader(in_);
        setFormatVersion(in_);
        setLibraryVersion(in_);
        setDataCompression(in_);
        openvdb::MetaMap().readMeta(in_);
        if (!inputHasGridOffsets()) failLayout("it has no table of its grids");
        for (auto count = readGridCount(in_); count > 0; --count) {
            grids_.emplace_back().read(in_);
            in_.seekg(grids_.back().getEndPos());
        }
    } catch (const std::ios::failure&) {
        throwFileError(path_, "cut short, or not readable");
    } catch (const openvdb::Exception& e) {
        throwFileError(path_, e.what());
    }
}

template <class T>
T PointLayoutReader::number() {
    T value{};
    in_.read(reinterpret_cast<char*>(&value), sizeof value);
    return value;
}

void PointLayoutReader::failLayout(const char* cause) const {
    throwFileError(
        path_, std::string("cannot be read in parts (") + cause + "): render it without --memory");
}

const openvdb::io::GridDescriptor& PointLayoutReader::find(const char* grid) const {
    for (const auto& descriptor : grids_)
        if (descriptor.gridName() == grid && !descriptor.isInstance()) return descriptor;
    throwFileError(path_, std::string("no grid '") + grid + "'");
}

/// The leaves in the file's order; in_ stands behind the topology afterwards.
PointLayout PointLayoutReader::readTopology(const openvdb::io::GridDescriptor& grid) {
    if (grid.gridType() != PointGrid::gridType())
        throwFileError(path_, "grid '" + grid.gridName() + "' is of another type");
    in_.seekg(grid.getGridPos());
    readGridCompression(in_);
    const auto points = PointGrid::create();
    points->readMeta(in_);
    points->readTransform(in_);
    points->readTopology(in_);
    PointLayout leaves;
    for (auto leaf = points->tree().cbeginLeaf(); leaf; ++leaf)
        leaves.push_back({leaf->origin(), 0, {}, {}});
    return leaves;
}

PointLayout PointLayoutReader::read(const char* grid, std::span<const AttributeSpec> wanted,
                                    std::vector<FilePage>& pages) {
    const openvdb::io::GridDescriptor& descriptor = find(grid);
    try {
        Pass pass{
            .leaves = readTopology(descriptor), .pages = pages, .voxelEndLengths = {}, .bytes = {}};
        const auto passes = number<std::uint16_t>();
        if (pass.leaves.empty()) return {};
        if (passes < 6 || passes % 2 != 0) failLayout("other passes than OpenVDB's");
        pass.attributes = (passes - 4u) / 2;
        for (std::size_t i = 0; i < pass.leaves.size(); ++i)
            pass.voxelEndLengths.push_back(number<std::uint16_t>());
        readSizes(pass, wanted);
        for (std::size_t a = 0; a < pass.attributes; ++a) readPageTable(pass, a);
        placeVoxelEnds(pass);
        auto position = static_cast<std::uint64_t>(in_.tellg());
        for (const auto& [begin, end] : pass.runs)
            for (std::size_t p = begin; p < end; ++p) {
                pages[p].offset = position;
                position += pages[p].stored;
            }
        if (position != static_cast<std::uint64_t>(descriptor.getEndPos()))
            failLayout("its pages do not end where the grid does");
        return std::move(pass.leaves);
    } catch (const std::ios::failure&) {
        throwFileError(path_, std::string("cut short or damaged: grid '") + grid + "'");
    } catch (const openvdb::Exception& e) {
        throwFileError(path_, std::string("damaged: grid '") + grid + "' (" + e.what() + ")");
    } catch (const std::bad_alloc&) {
        throwFileError(path_, "damaged (it asks for more memory than there is)");
    }
}

void PointLayoutReader::readSizes(Pass& pass, std::span<const AttributeSpec> wanted) {
    const auto header = number<std::uint8_t>();
    if (header != 1) failLayout("its leaves differ in their attributes");
    AttributeSet::Descriptor descriptor;
    descriptor.read(in_);
    if (descriptor.size() != pass.attributes) failLayout("other passes than OpenVDB's");
    pass.wantedIndex.assign(pass.attributes, kMostArrays);
    for (std::size_t w = 0; w < wanted.size(); ++w) {
        const std::size_t position = descriptor.find(wanted[w].name);
        if (position >= pass.attributes || descriptor.type(position) != wanted[w].type)
            throwFileError(path_, std::string("attribute '") + wanted[w].name +
                                      "' is missing or of another type");
        pass.wantedIndex[position] = w;
    }
    for (LeafPlace& leaf : pass.leaves)
        for (std::size_t a = 0; a < pass.attributes; ++a) {
            const auto length = number<std::uint64_t>();
            number<std::uint8_t>();  // flags that do not concern the layout
            const auto layout = number<std::uint8_t>();
            const auto points = number<std::uint32_t>();
            const openvdb::Index stride = layout & kStrided ? number<std::uint32_t>() : 1;
            if ((layout & ~(kStrided | kUniform)) != kPaged) failLayout("it is not in pages");
            // The length counts two numbers before the values.
            if (length <= 6 || length > kMostPageBytes) failLayout("an array without values");
            pass.bytes.push_back(static_cast<std::uint32_t>(length - 6));
            const std::size_t w = pass.wantedIndex[a];
            if (w == kMostArrays) continue;
            const bool uniform = layout & kUniform;
            if (uniform && wanted[w].valueBytes > 1 && std::uint64_t{points} * stride > 1)
                failLayout("one value for all of a leaf");
            if (stride != wanted[w].stride ||
                length - 6 !=
                    wanted[w].valueBytes * (uniform ? 1 : std::uint64_t{points} * stride) ||
                (leaf.points != 0 && leaf.points != points))
                throwFileError(
                    path_, std::string("damaged: attribute '") + wanted[w].name + "' of a leaf");
            leaf.points = points;
            leaf.arrays[w].uniform = uniform;
        }
}

void PointLayoutReader::readPageTable(Pass& pass, std::size_t attribute) {
    const std::size_t begin = pass.pages.size(), w = pass.wantedIndex[attribute];
    std::uint32_t filled = 0, size = 0;
    for (std::size_t i = 0; i < pass.leaves.size(); ++i) {
        const std::uint32_t bytes = pass.bytes[i * pass.attributes + attribute];
        if (filled == size) {
            const auto stored = number<std::int32_t>();  // less than 0: not packed
            const auto unpacked = stored > 0 ? number<std::int32_t>() : -std::int64_t{stored};
            if (unpacked <= 0 || unpacked > std::int64_t{kMostPageBytes})
                failLayout("a page without bytes");
            size = static_cast<std::uint32_t>(unpacked);
            filled = 0;
            pass.pages.push_back({0, stored > 0 ? static_cast<std::uint32_t>(stored) : size, size,
                                  stored > 0 ? FilePage::Kind::blosc : FilePage::Kind::plain});
        }
        if (bytes > size - filled) failLayout("an array over the end of its page");
        if (w < kMostArrays) {
            pass.leaves[i].arrays[w].page = static_cast<std::uint32_t>(pass.pages.size() - 1);
            pass.leaves[i].arrays[w].offset = filled & std::numeric_limits<std::int32_t>::max();
        }
        filled += bytes;
    }
    pass.runs.push_back({begin, pass.pages.size()});
}

/// Makes pages of the voxel ends, which lie one after the other; in_ goes behind them.
void PointLayoutReader::placeVoxelEnds(Pass& pass) {
    constexpr auto kPlain = std::numeric_limits<std::uint16_t>::max();
    constexpr std::uint32_t kHead =
        sizeof(openvdb::util::NodeMask<PointLeaf::LOG2DIM>) + sizeof(std::uint16_t);
    auto position = static_cast<std::uint64_t>(in_.tellg());
    for (std::size_t i = 0; i < pass.leaves.size(); ++i) {
        if (i % kVoxelEndLeaves == 0)
            pass.pages.push_back({position, 0, 0, FilePage::Kind::voxelEnds});
        FilePage& page = pass.pages.back();
        const std::uint16_t length = pass.voxelEndLengths[i];
        const std::uint32_t stored = kHead + (length == kPlain ? kVoxelEndBytes : length);
        pass.leaves[i].voxelEnds = {static_cast<std::uint32_t>(pass.pages.size() - 1),
                                    page.size & std::numeric_limits<std::int32_t>::max(), 0};
        page.stored += stored;
        page.size += kVoxelEndBytes;
        position += stored;
    }
    in_.seekg(static_cast<std::streamoff>(position));
}

}  // namespace shadowcache
