// Streams of KHR_draco_mesh_compression.

#include "common/import/draco_decoder.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    std::string cause;
    const DracoMesh mesh = decodeDraco({reinterpret_cast<const char*>(bytes), size}, cause);
    if (!cause.empty()) {
        fuzz::require(mesh.points == 0 && mesh.corners.empty() && mesh.attributes.empty());
        return 0;
    }
    for (const std::uint32_t corner : mesh.corners) fuzz::require(corner < mesh.points);
    for (const auto& [id, attribute] : mesh.attributes)
        fuzz::require(attribute.values.size() == mesh.points * attribute.components);
    return 0;
}
