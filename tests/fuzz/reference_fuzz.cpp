// Pictures of --reference and --resume: all channels and the metadata of an OpenEXR file.

#include "common/image/exr.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    static fuzz::InputFile file("in.exr");
    fuzz::readAs(file, {bytes, size}, [](const std::filesystem::path& path) {
        const ExrFile picture = readExr(path);
        for (const auto& channel : picture.channels)
            fuzz::require(channel.values.size() == static_cast<std::size_t>(picture.width) *
                                                       static_cast<std::size_t>(picture.height));
    });
    return 0;
}
