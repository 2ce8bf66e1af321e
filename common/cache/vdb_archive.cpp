#include "common/cache/vdb_archive.h"

#include <openvdb/io/Archive.h>

#include <mutex>
#include <new>
#include <ostream>
#include <streambuf>
#include <string_view>

#include "common/base/atomic_file.h"
#include "common/cache/checksums.h"

namespace shadowcache {

namespace {

/// Gives a stream's bytes to an AtomicFile, which buffers them.
class AtomicBuffer final : public std::streambuf {
public:
    explicit AtomicBuffer(AtomicFile& file) : file_(file) {}

protected:
    std::streamsize xsputn(const char* bytes, std::streamsize count) override {
        file_.write(bytes, static_cast<std::size_t>(count));
        return count;
    }
    int_type overflow(int_type byte) override {
        const char c = traits_type::to_char_type(byte);
        file_.write(&c, 1);
        return byte;
    }
    pos_type seekoff(off_type offset, std::ios_base::seekdir from,
                     std::ios_base::openmode) override {
        const auto here = static_cast<off_type>(file_.position());
        if (from == std::ios_base::end) return pos_type(off_type(-1));
        return seekpos(pos_type(from == std::ios_base::cur ? here + offset : offset), {});
    }
    pos_type seekpos(pos_type position, std::ios_base::openmode) override {
        file_.seek(static_cast<std::uint64_t>(off_type(position)));
        return position;
    }

private:
    AtomicFile& file_;
};

/// OpenVDB's writer on a stream that may seek; File, which has one too, opens its own stream.
class SeekableArchive final : public openvdb::io::Archive {
public:
    void writeSeekable(std::ostream& stream, const openvdb::GridCPtrVec& grids,
                       const openvdb::MetaMap& metadata) const {
        Archive::write(stream, grids, /*seekable=*/true, metadata);
    }
};

/// OpenVDB makes the name of a tree's type in a string stream, which ends early where memory does;
/// a file with such a name is one that nobody reads. A whole name ends in the depths of the tree,
/// which are the usual ones for all of our grids.
///
/// @throws std::bad_alloc
void requireTypes(const openvdb::GridCPtrVec& grids) {
    for (const auto& grid : grids)
        if (!std::string_view(grid->type()).ends_with("_5_4_3")) throw std::bad_alloc();
}

}  // namespace

void initializeOpenVdb() {
    static std::once_flag once;
    std::call_once(once, [] { openvdb::initialize(); });
}

openvdb::math::Transform::Ptr makeTransform(double spacing) {
    // OpenVDB refuses voxels below 1.5e-5 units: finer ones are shown a thousandfold; lookups go by
    // the metadata's spacing.
    constexpr double kLeastVoxel = 2e-5;
    while (spacing > 0 && spacing < kLeastVoxel) spacing *= 1000;
    return openvdb::math::Transform::createLinearTransform(spacing);
}

void writeVdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
              const openvdb::MetaMap& metadata) {
    requireTypes(grids);
    AtomicFile file(path);
    AtomicBuffer buffer(file);
    std::ostream stream(&buffer);
    // With this the file's own Error comes through the stream.
    stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
    SeekableArchive archive;
    archive.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
    archive.writeSeekable(stream, grids, metadata);
    sealFile(file);
    file.commit();
}

}  // namespace shadowcache
