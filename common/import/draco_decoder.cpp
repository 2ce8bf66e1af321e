#include "common/import/draco_decoder.h"

#include <draco/compression/decode.h>
#include <fmt/core.h>

#include <exception>
#include <new>

namespace shadowcache {

namespace {

/// Triangles and points that a byte may stand for, and those that any stream may have: the header
/// states what libdraco allocates.
constexpr double kMostVerticesPerByte = 256;
constexpr double kVerticesAlways = 0x1p20;

/// Why a stream is none that glTF may hold, or its counts cannot be: libdraco allocates what its
/// header states. Nothing if all is well.
///
/// Source: Draco bitstream specification, version 2.2: the header, and the first numbers of both
/// kinds of connectivity.
std::string badHeader(std::string_view bytes) {
    constexpr std::size_t kVersion = 5, kMethod = 8, kFlags = 9, kBegin = 11;
    constexpr unsigned kHasMetadata = 0x80, kEdgebreaker = 1;
    const auto byte = [&](std::size_t at) {
        return at < bytes.size() ? static_cast<unsigned char>(bytes[at]) : 0u;
    };
    if (!bytes.starts_with("DRACO")) return "the bytes do not begin with DRACO";
    if (byte(kVersion) != 2 || byte(kVersion + 1) != 2)
        return fmt::format("version {}.{}, expected 2.2", byte(kVersion), byte(kVersion + 1));
    // What follows it could not be found.
    if ((byte(kFlags + 1) & kHasMetadata) != 0) return "metadata in the stream, expected none";
    std::size_t at = kBegin + (byte(kMethod) == kEdgebreaker ? 1 : 0);  // the kind of traversal
    for (int i = 0; i < 2; ++i) {  // triangles and points, in either order
        std::uint64_t count = 0;
        bool ends = false;
        for (int k = 0; k < 5 && !ends; ++k, ++at) {
            count |= std::uint64_t{byte(at) & 127} << (7 * k);
            ends = byte(at) < 128;
        }
        if (static_cast<double>(count) >
            kVerticesAlways + kMostVerticesPerByte * static_cast<double>(bytes.size()))
            return fmt::format("{} triangles or points in {} bytes", count, bytes.size());
    }
    return {};
}

/// Numbers of a type as they are stored, normalized or not. libdraco's own conversion looks at what
/// a stream says of that, which may be no truth value, and at the first byte of a number only.
template <class T>
bool readValues(const draco::PointAttribute& from, std::uint32_t points, DracoAttribute& to) {
    std::vector<T> row(to.components);
    const std::size_t bytes = row.size() * sizeof(T);
    const std::size_t room = from.buffer() ? from.buffer()->data_size() : 0;
    for (std::uint32_t i = 0; i < points; ++i) {
        const draco::AttributeValueIndex at = from.mapped_index(draco::PointIndex(i));
        const std::int64_t first = from.GetBytePos(at);
        if (at.value() >= from.size() || first < 0 || bytes > room ||
            static_cast<std::uint64_t>(first) > room - bytes)
            return false;
        from.buffer()->Read(first, row.data(), bytes);
        for (const T value : row) to.values.push_back(static_cast<double>(value));
    }
    return true;
}

bool readAttribute(const draco::PointAttribute& from, std::uint32_t points, DracoAttribute& to) {
    to.components = static_cast<std::size_t>(from.num_components());
    to.values.reserve(points * to.components);
    switch (from.data_type()) {
        case draco::DT_INT8:
            return readValues<std::int8_t>(from, points, to);
        case draco::DT_UINT8:
            return readValues<std::uint8_t>(from, points, to);
        case draco::DT_INT16:
            return readValues<std::int16_t>(from, points, to);
        case draco::DT_UINT16:
            return readValues<std::uint16_t>(from, points, to);
        case draco::DT_INT32:
            return readValues<std::int32_t>(from, points, to);
        case draco::DT_UINT32:
            return readValues<std::uint32_t>(from, points, to);
        case draco::DT_FLOAT32:
            return readValues<float>(from, points, to);
        case draco::DT_FLOAT64:
            return readValues<double>(from, points, to);
        default:  // none that an accessor has
            return false;
    }
}

std::string readMesh(const draco::Mesh& from, DracoMesh& to) {
    to.points = from.num_points();
    for (std::uint32_t i = 0; i < from.num_faces(); ++i)
        for (const draco::PointIndex& corner : from.face(draco::FaceIndex(i))) {
            if (corner.value() >= to.points)
                return fmt::format("corner {}, expected one of {} points", corner.value(),
                                   to.points);
            to.corners.push_back(corner.value());
        }
    for (int i = 0; i < from.num_attributes(); ++i) {
        const draco::PointAttribute& attribute = *from.attribute(i);
        const auto [place, isNew] = to.attributes.try_emplace(attribute.unique_id());
        if (!isNew || !readAttribute(attribute, from.num_points(), place->second))
            return fmt::format("{} {}", isNew ? "damaged values of attribute" : "two attributes",
                               attribute.unique_id());
    }
    return {};
}

}  // namespace

DracoMesh decodeDraco(std::string_view bytes, std::string& cause) {
    DracoMesh mesh;
    cause = badHeader(bytes);
    if (!cause.empty()) return mesh;
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    try {
        auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
        cause = decoded.ok() ? readMesh(*decoded.value(), mesh)
                             : "damaged: " + decoded.status().error_msg_string();
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {  // the boundary: libdraco's own containers throw
        cause = std::string("damaged: ") + e.what();
    }
    if (!cause.empty()) return {};
    return mesh;
}

}  // namespace shadowcache
