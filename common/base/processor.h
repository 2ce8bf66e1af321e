#pragma once

#include <string>

namespace shadowcache {

/// The widest instruction set of this machine that Embree has code for: "avx512", "avx2", "avx" or
/// "sse4.2". Which of two triangles a ray meets at their edge may depend
/// on it (docs/farm.md).
std::string instructionSet();

}  // namespace shadowcache
