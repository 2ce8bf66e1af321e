#include "common/predict/emitter_visibility.h"

#include <array>

namespace shadowcache {

void EmitterVisibility::shares(std::span<const ItemView> items,
                               std::span<float> shares) const noexcept {
    for (std::size_t e = 0; e < emitters_; ++e) {
        float visible = 0, rays = 0;
        for (const ItemView& item : items) {
            const Count& count = counts_[item.number * emitters_ + e];
            visible += item.weight * static_cast<float>(count.visible);
            rays += item.weight * static_cast<float>(count.rays);
        }
        shares[e] = rays > 0 ? visible / rays : kUnknown;
    }
}

void EmitterVisibility::shares(std::uint64_t item, std::span<float> shares) const noexcept {
    for (std::size_t e = 0; e < emitters_; ++e) {
        const Count& count = counts_[item * emitters_ + e];
        shares[e] = count.rays > 0
                        ? static_cast<float>(count.visible) / static_cast<float>(count.rays)
                        : kUnknown;
    }
}

}  // namespace shadowcache
