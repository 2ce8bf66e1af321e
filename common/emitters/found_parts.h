#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/emitters/emission_table.h"
#include "common/emitters/emitter_part.h"

namespace shadowcache {

/// What parts are weighed by.
enum class EmitterWeight {
    radiance,  ///< what they emit
    shape      ///< triangles and lamps each alike, without lamps that move
};

/// A part, and what it belongs to: parts of one owner that have corners in common are together.
struct FoundPart {
    EmitterPart part;
    std::uint64_t owner = 0;
};

/// Parts, and the tables of those triangles whose pictures emit unevenly.
struct FoundParts {
    std::vector<FoundPart> parts;
    std::vector<EmissionTable> tables;  ///< EmitterPart::table
};

/// All that emits of meshes of one origin: triangles of surfaces, then the lamps. Tables are made
/// by what they emit alone, for EmitterWeight::radiance.
FoundParts findParts(std::span<const TriangleMesh* const> meshes, EmitterWeight weight);

}  // namespace shadowcache
