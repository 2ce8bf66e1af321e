#pragma once

#include <span>

#include "common/mesh/looks.h"
#include "common/trace/hit.h"

namespace shadowcache {

/// A surface that a camera's ray may pass by chance, where it crosses it.
struct Crossing {
    int ray;  ///< of its packet
    Hit hit;
    Passage passage;
    bool isPane;
};

/// Which of the surfaces that a ray crosses it shows: as CameraPacket::chance and Scene::look()
/// say.
struct CrossingChoice {
    float chance, leastOfPanes;
};

/// One of the surfaces that a ray crosses, or what it meets at its end, with share, tint and cover.
///
/// @param crossings  up to the end, in the order of the way
Hit chosenOf(std::span<const Crossing> crossings, const Hit& end, const CrossingChoice& choice);

}  // namespace shadowcache
