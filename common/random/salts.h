#pragma once

#include "common/base/hash.h"

namespace shadowcache {

// Second words of hashWords: what the numbers drawn from a seed are for. Two uses of one seed with
// one salt would draw the same numbers, so every salt has a value and a use of its own, which
// tests/source_check verifies. Seeds of one enumeration never meet those of another.

enum class BakeSalt : std::uint64_t {
    originU = 1,  ///< place of an origin in its triangle
    originV = 2,
    rays = 0x72617973,     ///< directions and origins of an item's rays; third word: which step's
    patch = 0x7061746368,  ///< a patch's own seed; third word: its code
    filmColumn =
        0x66696c6d,  ///< place of a camera ray that looks for voxels; third word: its number
    filmRow = 0x66696c6e,
    lensU = 0x66696c6f,  ///< where on the lens it starts
    lensV = 0x66696c70,
    shutterTime = 0x66696c71,  ///< and when
    crossing = 0x66696c72,     ///< which of the surfaces that it may pass it shows
    hitOrigins = 0x68697473,   ///< points that an item's hit rays start from
    emitterRays = 0x6c616d70,  ///< an item's rays to an emitter; third word: its number
    sample = 0x73616d70,       ///< voxels that an estimate bakes; third word: their run's number
};

/// Seeds of frames and of their pilots' places.
enum class FrameSalt : std::uint64_t {
    pilotPlaces = 1,     ///< places on the film that a pilot looks at
    rulePixel = 4,       ///< a pixel that a frame's rule is made of; third word: column or row
    visibleEmitter = 5,  ///< points of a triangle that a frame looks for; third word: its number
    visibleEmitterCount = 6,  ///< rounds their number
    someTiles = 82,           ///< which tiles are rendered for an estimate of the whole frame
    tileBorder =
        84,  ///< offsets the borders of tiles pixel by pixel; the first word, without a seed
};

/// Seeds of pixels. A family takes as many values as its comment says.
enum class RenderSalt : std::uint64_t {
    owenScramble = 1,       ///< a dimension of Sobol' points; family of 4
    randomWord = 16,        ///< a word of a random sequence, by dimension; family of 4
    lowBits = 77,           ///< bits of a sample word below its 32nd
    texelPlace = 78,        ///< place of a sample in a texel of the map
    misTurn = 79,           ///< which of `mis`'s strategies has the first sample
    pilotRay = 81,          ///< regions and directions of a pilot point's rays
    shareRounding = 82,     ///< rounds the samples of a cluster's points
    clusterJitter = 83,     ///< numbers of a point's samples in a cluster
    clusterOrder = 85,      ///< the sequence that orders the samples of a cluster
    gloss = 86,             ///< a pixel's seed for the samples of its glossy surfaces
    glossTurn = 87,         ///< which of their strategies has the first sample
    glossLobes = 88,        ///< samples of the lobes of a cluster's points
    glossRounding = 89,     ///< rounds these samples' numbers
    glossCluster = 94,      ///< a pixel's seed for the samples of its glossy points in clusters
    glossShare = 95,        ///< rounds the samples of their regions
    spreadRays = 96,        ///< camera rays that decide how many a pixel gets
    emissionRays = 116,     ///< a pixel's seed for rays that look for what emits alone
    bounceFirst = 97,       ///< a camera point's seed for the light that bounces to it
    bounceSends = 98,       ///< whether a vertex of a path sends rays; third word: which
    bounceSequence = 99,    ///< a pixel's seed for the first diffuse rays of its paths
    bounceGroup = 100,      ///< a group's seed for the diffuse rays of its vertices
    bounceShuffle = 101,    ///< which vertices of a cluster make a group
    bounceLobe = 102,       ///< direction of a ray by a vertex's lobe; third word: the dimension
    bounceChild = 103,      ///< seed of what a diffuse ray met
    bounceLobeChild = 104,  ///< and of what a lobe's ray met
    bounceDirect = 105,     ///< seed of a vertex's direct light
    shutterTime = 106,      ///< a pixel's seed for when its camera rays are sent
    crossing = 119,         ///< and for which of the surfaces that they may pass they show
    clusterTrial = 114,     ///< a cluster's seed for rays that try where its light comes from
    trialRay = 115,         ///< direction of such a ray
    mirroredSky = 117,  ///< what a vertex mirrors to a place; third word: its number in the group
    mirroredSkyTurn = 118,  ///< which members of its group see it
    bounceSender = 108,     ///< which camera ray of a run sends rays; third word: the run
    placeSamples = 107,     ///< the sequence of a place's samples; third word: its number
    domePilotTile = 90,     ///< tiles of the map that `dome`'s pilot rays go to
    domePilotTexel = 91,    ///< places of these rays in their texels
    domeTurn = 92,          ///< which of `dome`'s samples is the first drawn by the cosine
    domeTexel = 93,         ///< place of a sample in a texel of its tile
    emitterSamples = 109,   ///< a pixel's seed for its samples of emitters
    emitterGloss = 110,     ///< the same for those of its glossy surfaces
    emitterGuess = 112,     ///< the same without rays, as lobes are predicted
    emitterLobe = 111,      ///< and for the rays of their lobes that look for emitters
};

/// Member `i` of a salt's family.
constexpr RenderSalt operator+(RenderSalt family, int i) {
    return static_cast<RenderSalt>(static_cast<std::uint64_t>(family) +
                                   static_cast<std::uint64_t>(i));
}

constexpr std::uint64_t hashWords(std::uint64_t seed, BakeSalt salt, std::uint64_t c = 0) {
    return hashWords(seed, static_cast<std::uint64_t>(salt), c);
}
constexpr std::uint64_t hashWords(std::uint64_t seed, FrameSalt salt, std::uint64_t c = 0) {
    return hashWords(seed, static_cast<std::uint64_t>(salt), c);
}
constexpr std::uint64_t hashWords(FrameSalt salt, std::uint64_t b, std::uint64_t c) {
    return hashWords(static_cast<std::uint64_t>(salt), b, c);
}
constexpr std::uint64_t hashWords(std::uint64_t seed, RenderSalt salt, std::uint64_t c = 0) {
    return hashWords(seed, static_cast<std::uint64_t>(salt), c);
}

}  // namespace shadowcache
