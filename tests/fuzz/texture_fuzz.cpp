// PNG, JPEG and WebP pictures, as textures of glTF files hold them.

#include "common/import/texture_decoder.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    std::string cause;
    const Texture texture = decodeTexture({reinterpret_cast<const char*>(bytes), size}, cause);
    fuzz::require(texture.rgba.empty()
                      ? !cause.empty()
                      : texture.rgba.size() == 4 * static_cast<std::size_t>(texture.width) *
                                                   static_cast<std::size_t>(texture.height));
    return 0;
}
