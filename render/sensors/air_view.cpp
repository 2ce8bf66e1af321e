#include "render/sensors/air_view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/math/direction_mesh.h"
#include "common/mesh/placed_mesh.h"
#include "common/shot/view.h"

namespace shadowcache {

namespace {

/// Unit vectors through the middles of the cells.
const std::vector<Vec3f>& middlesOfCells() {
    static const std::vector<Vec3f> kMiddles = [] {
        std::vector<Vec3f> all;
        for (std::uint32_t cell = 0; cell < cellCount(Environment::kLevel); ++cell)
            all.emplace_back(cellCenter(Environment::kLevel, cell));
        return all;
    }();
    return kMiddles;
}

}  // namespace

Vec3f rayStartInAir(const Scene& scene, const Vec3d& position, const Vec3f& normal) {
    constexpr float kOff = 0x1p-20f;  // in units of the largest coordinate
    const Vec3f place(position - scene.mesh().origin);
    return place +
           normal * (kOff * std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}));
}

AirViewer::AirViewer(const Scene& scene, const PatchCosines& cosines, const ItemTable* items)
    : scene_(scene),
      cosines_(cosines),
      items_(items),
      shares_(cellCount(Environment::kLevel)),
      view_{std::vector<float>(shares_.size()), {}} {}

const AirView& AirViewer::look(const Vec3d& position, const Vec3f& normal) {
    cosines_.at(Environment::kLevel, normal, shares_);
    std::ranges::fill(view_.sky, 0.0f);
    view_.met.clear();
    known_ = unknown_ = 0;
    start_ = rayStartInAir(scene_, position, normal);
    std::array<std::uint32_t, RayPacket::kSize> cells;
    int count = 0;
    for (std::uint32_t cell = 0; cell < shares_.size(); ++cell) {
        if (!(shares_[cell] > 0)) continue;
        shares_[cell] *= cosines_.solidAngle(Environment::kLevel, cell);
        cells[static_cast<std::size_t>(count++)] = cell;
        if (count < RayPacket::kSize) continue;
        trace(cells.data(), count);
        count = 0;
    }
    trace(cells.data(), count);
    // What has no item is taken to be as bright as the rest.
    if (known_ > 0)
        for (AirView::Met& met : view_.met)
            met.share *= static_cast<float>((known_ + unknown_) / known_);
    return view_;
}

void AirViewer::trace(const std::uint32_t* cells, int count) {
    RayPacket packet{};
    std::array<Hit, RayPacket::kSize> hits;
    for (int i = 0; i < count; ++i) packet.set(i, start_, middlesOfCells()[cells[i]]);
    scene_.meet(packet, count, hits.data());
    for (int i = 0; i < count; ++i) {
        const Hit& hit = hits[static_cast<std::size_t>(i)];
        const std::uint32_t cell = cells[i];
        if (!hit.found) {
            view_.sky[cell] = shares_[cell];
        } else if (items_) {
            const Vec3f side = View{middlesOfCells()[cell], hit}.geometricNormal();
            if (side != hit.normal && !isDoubleSided(scene_.mesh(), hit.triangle)) continue;
            const std::uint32_t item = items_->itemAt(worldPosition(scene_, hit), side);
            (item == kNoItem ? unknown_ : known_) += static_cast<double>(shares_[cell]);
            if (item != kNoItem) view_.met.push_back({item, shares_[cell]});
        }
    }
}

}  // namespace shadowcache
