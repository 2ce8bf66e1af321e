#include "tests/support/environment_maps.h"

#include <cmath>
#include <functional>
#include <unordered_set>

#include "common/base/error.h"
#include "common/image/radiance.h"
#include "tests/support/test_scenes.h"

namespace shadowcache::test {

namespace {

Image sunMap(int width, int height) {
    Image map = constantMap(Rgb(1, 1, 1));
    map.width = width;
    map.height = height;
    map.pixels.assign(static_cast<std::size_t>(width * height), Rgb(0.1f, 0.2f, 0.4f));
    map.pixels[static_cast<std::size_t>(width * (height / 4) + width / 3)] = Rgb(1e9f, 9e8f, 8e8f);
    return map;
}

Image bundledMap(const std::string& name) {
    return readRadiance(std::string(SHADOWCACHE_MAPS) + "/" + name + ".exr").image;
}

/// How a map is made.
struct MapRecipe {
    std::string name;
    std::function<Image()> make;
    double rotation = 0;
};

std::vector<MapRecipe> recipes() {
    const Rgb plain(0.5f, 1, 3), single(5, 6, 7);
    return {{"Noise", [] { return noiseMap(200, 90, 2); }, 77.7},
            {"Gradient",
             [] {
                 return gradientMap(64, 32, {0.3, 0.8, -0.2});
             }},
            {"OddSize", [] { return noiseMap(37, 61, 3); }, -123},
            {"OneByOne",
             [=] {
                 return Image{1, 1, {plain}};
             }},
            {"AllEqual", [=] { return constantMap(plain); }, 20},
            {"OneTexel", [=] { return oneTexelMap(64, 32, 11, 9, single); }},
            {"OneTexelAtThePole", [=] { return oneTexelMap(64, 32, 11, 0, single); }},
            {"OneSmallTexel", [=] { return oneTexelMap(1300, 650, 700, 300, single); }},
            {"Sun", [] { return sunMap(512, 256); }},
            {"CoarseSun", [] { return sunMap(8, 4); }},
            {"courtyard", [] { return bundledMap("courtyard"); }},
            {"interior", [] { return bundledMap("interior"); }},
            {"sunrise", [] { return bundledMap("sunrise"); }}};
}

}  // namespace

std::vector<std::string> litMapNames() {
    std::vector<std::string> names;
    for (const MapRecipe& recipe : recipes()) names.push_back(recipe.name);
    return names;
}

NamedMap litMap(const std::string& name) {
    for (const MapRecipe& recipe : recipes())
        if (recipe.name == name) return {name, recipe.make(), recipe.rotation};
    throw Error(name + ": no such map");
}

Vec3d unturned(const Vec3d& w, double angle) {
    return {w.x * std::cos(angle) - w.z * std::sin(angle), w.y,
            w.x * std::sin(angle) + w.z * std::cos(angle)};
}

Texels::Texels(const Environment& environment, double rotationDegrees)
    : environment_(environment), rotation_(rotationDegrees * kPi / 180) {
    std::unordered_set<float> heights;
    cellOf_.resize(environment.texelCount());
    for (std::uint32_t c = 0; c < cellCount(Environment::kLevel); ++c)
        environment.forEachTexel(c, [&](std::uint32_t i) {
            cellOf_[i] = c;
            heights.insert(environment.texel(i).center.y);
        });
    height_ = static_cast<int>(heights.size());
    width_ = static_cast<int>(cellOf_.size()) / height_;
    rankOf_.resize(cellOf_.size());
    for (std::size_t i = 0; i < cellOf_.size(); ++i)
        rankOf_[place(environment.texel(i).center)] = i;
}

double Texels::solidAngle(std::size_t i) const {
    return static_cast<double>(environment_.texel(i).solidAngle);
}

double Texels::luminanceIntegral(std::size_t i) const {
    return static_cast<double>(environment_.luminance(environment_.texel(i).radiance)) *
           solidAngle(i);
}

Vec3d Texels::moment(std::size_t i) const {
    const std::size_t at = place(environment_.texel(i).center);
    const auto width = static_cast<std::size_t>(width_);
    return unturned(
        texelMoment(width_, height_, static_cast<int>(at % width), static_cast<int>(at / width)),
        -rotation_);
}

std::size_t Texels::place(const Vec3f& direction) const {
    const auto [x, y] = texelAt(width_, height_, unturned(Vec3d(direction), rotation_));
    return static_cast<std::size_t>(y * width_ + x);
}

}  // namespace shadowcache::test
