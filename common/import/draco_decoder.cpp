#include "common/import/draco_decoder.h"

#include <draco/compression/decode.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <new>

namespace shadowcache {

namespace {

/// Triangles and points that a byte may stand for, and those that any stream may have: the header
/// states what libdraco allocates.
constexpr double kMostPerByte = 256;
constexpr double kAlwaysAllowed = 0x1p20;

/// The first numbers of a stream, as far as they are there: what comes behind them is libdraco's.
class Header {
public:
    explicit Header(std::string_view bytes) : bytes_(bytes) {}

    /// Largest of the counts of the mesh: its triangles and its points.
    double largestCount() {
        constexpr std::size_t kMethod = 8, kFlags = 9, kBegin = 11;
        constexpr unsigned kHasMetadata = 0x80;
        if (bytes_.size() < kBegin) return 0;
        const unsigned major = byte(5), minor = byte(6);
        // Metadata would have to be parsed to find what follows it.
        if (byte(kFlags + 1) & kHasMetadata) return 0;
        const bool wide = major < 2 || (major == 2 && minor < 2);
        at_ = kBegin;
        if (byte(kMethod) == 1) ++at_;  // Edgebreaker's kind of traversal
        const double first = number(wide);
        return std::max(first, number(wide));
    }

private:
    unsigned byte(std::size_t at) const {
        return at < bytes_.size() ? static_cast<unsigned char>(bytes_[at]) : 0;
    }

    /// Of four bytes, or seven bits a byte.
    double number(bool wide) {
        double value = 0, scale = 1;
        for (int k = 0; k < 5; ++k, ++at_) {
            if (wide && k == 4) break;
            value += scale * (wide ? byte(at_) : byte(at_) & 127);
            scale *= wide ? 256 : 128;
            if (!wide && byte(at_) < 128) {
                ++at_;
                break;
            }
        }
        return value;
    }

    std::string_view bytes_;
    std::size_t at_ = 0;
};

/// Whole numbers stay as they are stored, normalized or not.
template <class T>
bool readValues(const draco::PointAttribute& from, std::uint32_t points, DracoAttribute& to) {
    const auto components = static_cast<std::int8_t>(to.components);
    std::vector<T> row(to.components);
    for (std::uint32_t i = 0; i < points; ++i) {
        const draco::AttributeValueIndex at = from.mapped_index(draco::PointIndex(i));
        if (at.value() >= from.size() || !from.ConvertValue<T>(at, components, row.data()))
            return false;
        for (const T value : row) to.values.push_back(static_cast<double>(value));
    }
    return true;
}

bool readAttribute(const draco::PointAttribute& from, std::uint32_t points, DracoAttribute& to) {
    to.components = static_cast<std::size_t>(from.num_components());
    to.values.reserve(points * to.components);
    if (from.data_type() == draco::DT_FLOAT32) return readValues<float>(from, points, to);
    if (from.data_type() == draco::DT_FLOAT64) return readValues<double>(from, points, to);
    return readValues<std::int64_t>(from, points, to);
}

std::string readMesh(const draco::Mesh& from, DracoMesh& to) {
    to.points = from.num_points();
    for (std::uint32_t i = 0; i < from.num_faces(); ++i)
        for (const draco::PointIndex& corner : from.face(draco::FaceIndex(i))) {
            if (corner.value() >= to.points)
                return "corner " + std::to_string(corner.value()) + ", expected one of " +
                       std::to_string(to.points) + " points";
            to.corners.push_back(corner.value());
        }
    for (int i = 0; i < from.num_attributes(); ++i) {
        const draco::PointAttribute& attribute = *from.attribute(i);
        if (!readAttribute(attribute, from.num_points(), to.attributes[attribute.unique_id()]))
            return "damaged values of attribute " + std::to_string(attribute.unique_id());
    }
    return {};
}

}  // namespace

DracoMesh decodeDraco(std::string_view bytes, std::string& cause) {
    DracoMesh mesh;
    if (!bytes.starts_with("DRACO")) {
        cause = "the bytes do not begin with DRACO";
        return mesh;
    }
    const double count = Header(bytes).largestCount();
    if (count > kAlwaysAllowed + kMostPerByte * static_cast<double>(bytes.size())) {
        cause = std::to_string(static_cast<long long>(count)) + " triangles or points in " +
                std::to_string(bytes.size()) + " bytes";
        return mesh;
    }
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
