// What a shot looks up, as a file of shadowcache-bake --lookups-only. Each input gets the checksum
// of what it is, so that the reader behind the checksum is met.

#include "bake/shot/lookup_file.h"
#include "common/base/content_hash.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    static fuzz::InputFile file("in.lookups");
    const std::uint64_t sum = checksum(std::as_bytes(std::span(bytes, size)));
    std::vector<std::uint8_t> sealed(bytes, bytes + size);
    for (std::size_t k = 0; k < sizeof sum; ++k)
        sealed.push_back(static_cast<std::uint8_t>(sum >> 8 * k));
    fuzz::readAs(file, sealed, [](const std::filesystem::path& path) {
        const ShotLookups lookups = readLookups(path, {{"version", "1"}});
        fuzz::require(lookups.spacing > 0);
        for (const LookupPlaces::Place& place : lookups.places.places())
            fuzz::require(place.isValid());
    });
    return 0;
}
