// Tracks of moving files.

#include "common/shot/moving_set.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    static fuzz::InputFile file("in.json");
    fuzz::readAs(file, {bytes, size}, [](const std::filesystem::path& path) {
        for (const Affine& place : readTransformTrack(path)) fuzz::require(place.isFinite());
    });
    return 0;
}
