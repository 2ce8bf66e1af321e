#include "common/shot/moving_lamps.h"

#include "common/import/gltf_placed_lamps.h"
#include "common/import/lamp_gain.h"
#include "common/import/lamp_place.h"

namespace shadowcache {

MovingLamps::MovingLamps(std::span<const GltfShot> shots, std::span<const DynamicObject> objects,
                         const MeshOptions& options, const Vec3d& origin)
    : shots_(shots), objects_(objects), options_(options), origin_(origin) {}

void MovingLamps::setGains(std::span<const LampGain> gains) {
    options_.gains.assign(gains.begin(), gains.end());
}

/// In the world.
Lamp MovingLamps::lampAt(const GltfShot& shot, int node, int frame) const {
    const GltfLampPlace found = gltfLampAt(shot.document(), shot.nodes(), node, frame / shot.fps());
    Lamp lamp = lampOfSet(shot.document().path, found.lamp, options_);
    if (!found.isThere) lamp.gain = Rgb(0, 0, 0);
    return lamp;
}

std::vector<Lamp> MovingLamps::unplaced() const {
    std::vector<Lamp> lamps;
    if (!options_.lamps) return lamps;
    const auto add = [&](const GltfShot& shot, const std::vector<int>& nodes) {
        for (const int node : nodes) {
            Lamp& lamp = lamps.emplace_back(gltfLampOf(shot.document(), node));
            changeUnit(lamp, options_.scale);
            lamp.gain = lampGainOf(lamp.name, options_.gains);
            lamp.moves = true;
        }
    };
    for (const GltfShot& shot : shots_) add(shot, shot.movingLampNodes());
    for (const DynamicObject& object : objects_)
        if (object.shot) add(*object.shot, lampNodes(object.shot->document()));
    return lamps;
}

std::vector<Lamp> MovingLamps::at(int frame) const {
    std::vector<Lamp> lamps;
    if (!options_.lamps) return lamps;
    for (const GltfShot& shot : shots_)
        for (const int node : shot.movingLampNodes()) lamps.push_back(lampAt(shot, node, frame));
    for (const DynamicObject& object : objects_) {
        if (!object.shot) continue;
        const std::optional<Affine> track = object.trackAt(frame);
        for (const int node : lampNodes(object.shot->document())) {
            const Lamp lamp = lampAt(*object.shot, node, frame);
            lamps.push_back(track ? trackedLamp(object.file.mesh, lamp, *track) : lamp);
        }
    }
    for (Lamp& lamp : lamps) {
        lamp.position -= origin_;
        lamp.moves = true;
    }
    return lamps;
}

}  // namespace shadowcache
