// Lines of shadowcache-render --serve.

#include "render/serve/requests.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    const Request request = parseRequest({reinterpret_cast<const char*>(bytes), size});
    fuzz::require(request.command.has_value() == request.error.empty());
    fuzz::require(!request.command || request.number);
    return 0;
}
