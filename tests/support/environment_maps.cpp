#include "tests/support/environment_maps.h"

#include <cmath>
#include <unordered_set>

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

NamedMap bundledMap(const std::string& name) {
    return {name, readRadiance(std::string(SHADOWCACHE_MAPS) + "/" + name + ".exr").image};
}

}  // namespace

std::vector<NamedMap> litMaps() {
    return {{"Noise", noiseMap(200, 90, 2), 77.7},
            {"Gradient", gradientMap(64, 32, {0.3, 0.8, -0.2})},
            {"OddSize", noiseMap(37, 61, 3), -123},
            {"OneByOne", {1, 1, {Rgb(0.5f, 1, 3)}}},
            {"AllEqual", constantMap(Rgb(0.5f, 1, 3)), 20},
            {"OneTexel", oneTexelMap(64, 32, 11, 9, Rgb(5, 6, 7))},
            {"OneTexelAtThePole", oneTexelMap(64, 32, 11, 0, Rgb(5, 6, 7))},
            {"OneSmallTexel", oneTexelMap(1300, 650, 700, 300, Rgb(5, 6, 7))},
            {"Sun", sunMap(512, 256)},
            {"CoarseSun", sunMap(8, 4)},
            bundledMap("courtyard"),
            bundledMap("interior"),
            bundledMap("sunrise")};
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
