// Buffer views of EXT_meshopt_compression: mode, filter, stride and number of elements in five
// bytes, then the stream.

#include "common/import/meshopt_decoder.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    constexpr std::size_t kHead = 5;
    if (size < kHead) return 0;
    constexpr std::array<const char*, 4> kModes{"ATTRIBUTES", "TRIANGLES", "INDICES", "OTHER"};
    constexpr std::array<const char*, 4> kFilters{"NONE", "OCTAHEDRAL", "QUATERNION",
                                                  "EXPONENTIAL"};
    MeshoptView view;
    view.mode = kModes[bytes[0] & 3u];
    view.filter = kFilters[bytes[1] & 3u];
    view.stride = bytes[2] + std::size_t{1};
    view.count = bytes[3] + std::size_t{256} * bytes[4];
    std::string cause;
    const std::string decoded =
        decodeMeshopt(view, {reinterpret_cast<const char*>(bytes) + kHead, size - kHead}, cause);
    fuzz::require(cause.empty() ? decoded.size() == view.count * view.stride : decoded.empty());
    return 0;
}
