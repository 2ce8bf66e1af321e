#include "common/import/meshopt_decoder.h"

#include <fmt/core.h>
#include <meshoptimizer.h>

namespace shadowcache {

namespace {

/// Bytes of attributes that one of the stream stands for, at most: two bits say what sixteen bytes
/// are. Of indices each element or triangle takes a byte.
constexpr double kMostAttributesPerByte = 64;
constexpr std::size_t kMostStride = 256;
/// Elements of 256 bytes in the last block, which is filled up.
constexpr double kBlock = 65536;

bool isIndices(const MeshoptView& view) {
    return view.mode == "TRIANGLES" || view.mode == "INDICES";
}

/// Why the numbers of a view do not fit together, or nothing if they do.
std::string badView(const MeshoptView& view, std::size_t bytes) {
    const std::string stride = fmt::format("byteStride {}", view.stride);
    if (view.mode != "ATTRIBUTES" && !isIndices(view))
        return "mode '" + view.mode.substr(0, 20) + "', expected ATTRIBUTES, TRIANGLES or INDICES";
    if (isIndices(view) && view.stride != 2 && view.stride != 4)
        return stride + ", expected 2 or 4";
    if (view.stride == 0 || view.stride > kMostStride || (!isIndices(view) && view.stride % 4 != 0))
        return stride + ", expected a multiple of 4 up to 256";
    if (view.mode == "TRIANGLES" && view.count % 3 != 0)
        return fmt::format("count {}, expected a multiple of 3", view.count);
    const double perByte =
        isIndices(view) ? 3 * static_cast<double>(view.stride) : kMostAttributesPerByte;
    if (static_cast<double>(view.count) * static_cast<double>(view.stride) >
        perByte * static_cast<double>(bytes) + kBlock)
        return fmt::format("{} elements in {} bytes, expected fewer", view.count, bytes);
    return {};
}

/// Why a filter cannot follow a mode, or nothing if it can.
std::string badFilter(const MeshoptView& view) {
    if (view.filter == "NONE") return {};
    const bool known =
        view.filter == "OCTAHEDRAL" || view.filter == "QUATERNION" || view.filter == "EXPONENTIAL";
    if (!known || isIndices(view))
        return "filter '" + view.filter.substr(0, 20) + "' of mode " + view.mode +
               ", expected NONE or, of attributes, OCTAHEDRAL, QUATERNION or EXPONENTIAL";
    const bool fits = view.filter == "EXPONENTIAL"  ? view.stride % 4 == 0
                      : view.filter == "OCTAHEDRAL" ? view.stride == 4 || view.stride == 8
                                                    : view.stride == 8;
    return fits ? std::string()
                : fmt::format(
                      "byteStride {} with filter {}, expected 4 or 8 (OCTAHEDRAL), 8 (QUATERNION)",
                      view.stride, view.filter);
}

int decodeBytes(const MeshoptView& view, std::string_view bytes, std::string& to) {
    const auto* from = reinterpret_cast<const unsigned char*>(bytes.data());
    if (view.mode == "TRIANGLES")
        return meshopt_decodeIndexBuffer(to.data(), view.count, view.stride, from, bytes.size());
    if (view.mode == "INDICES")
        return meshopt_decodeIndexSequence(to.data(), view.count, view.stride, from, bytes.size());
    return meshopt_decodeVertexBuffer(to.data(), view.count, view.stride, from, bytes.size());
}

}  // namespace

std::string decodeMeshopt(const MeshoptView& view, std::string_view bytes, std::string& cause) {
    cause = badView(view, bytes.size());
    if (cause.empty()) cause = badFilter(view);
    if (!cause.empty()) return {};
    std::string decoded(view.count * view.stride, '\0');
    if (decodeBytes(view, bytes, decoded) != 0) {
        cause = "damaged, or no data of mode " + view.mode;
        return {};
    }
    if (view.filter == "OCTAHEDRAL")
        meshopt_decodeFilterOct(decoded.data(), view.count, view.stride);
    if (view.filter == "QUATERNION")
        meshopt_decodeFilterQuat(decoded.data(), view.count, view.stride);
    if (view.filter == "EXPONENTIAL")
        meshopt_decodeFilterExp(decoded.data(), view.count, view.stride);
    return decoded;
}

}  // namespace shadowcache
