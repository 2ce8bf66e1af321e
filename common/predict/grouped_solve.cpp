#include "common/predict/grouped_solve.h"

namespace shadowcache {

GroupedSolve::GroupedSolve(const BounceSolve& whole, const Transport& transport,
                           std::span<const ItemLook> looks,
                           std::span<const std::vector<Rgb>> lights, bool firstShines)
    : whole_(whole), firstShines_(firstShines) {
    others_.reserve(lights.size());
    for (const std::vector<Rgb>& light : lights.subspan(1))
        others_.push_back(whole.ofPart(transport, looks, light));
}

template <class Where>
void GroupedSolve::indirectOf(const Where& where, int bounces, std::span<Rgb> light) const {
    Rgb rest = firstShines_ ? whole_.indirect(where, bounces) : Rgb(0, 0, 0);
    for (std::size_t g = 1; g < light.size(); ++g) {
        light[g] = others_[g - 1].indirect(where, bounces);
        if (firstShines_) rest -= light[g];
    }
    light.front() = rest;
}

void GroupedSolve::indirect(std::uint32_t item, int bounces, std::span<Rgb> light) const {
    indirectOf(item, bounces, light);
}

void GroupedSolve::indirect(std::span<const ItemView> items, int bounces,
                            std::span<Rgb> light) const {
    indirectOf(items, bounces, light);
}

std::size_t GroupedSolve::memoryBytes() const {
    std::size_t bytes = 0;
    for (const BounceSolve& solve : others_) bytes += solve.memoryBytes();
    return bytes;
}

}  // namespace shadowcache
