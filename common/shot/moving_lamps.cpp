#include "common/shot/moving_lamps.h"

#include "common/import/gltf_placed_lamps.h"
#include "common/import/lamp_place.h"

namespace shadowcache {

MovingLamps::MovingLamps(std::span<const GltfShot> shots, const MeshOptions& options,
                         const Vec3d& origin)
    : shots_(shots), options_(options), origin_(origin) {}

void MovingLamps::setGains(std::span<const LampGain> gains) {
    options_.gains.assign(gains.begin(), gains.end());
}

std::vector<Lamp> MovingLamps::at(int frame) const {
    std::vector<Lamp> lamps;
    if (!options_.lamps) return lamps;
    for (const GltfShot& shot : shots_)
        for (const int node : shot.movingLampNodes()) {
            const GltfLampPlace found =
                gltfLampAt(shot.document(), shot.nodes(), node, frame / shot.fps());
            Lamp& lamp = lamps.emplace_back(lampOfSet(shot.document().path, found.lamp, options_));
            lamp.position -= origin_;
            lamp.moves = true;
            if (!found.isThere) lamp.gain = Rgb(0, 0, 0);
        }
    return lamps;
}

}  // namespace shadowcache
