#include "common/image/primaries.h"

#include <OpenEXR/ImfChromaticities.h>
#include <OpenEXR/ImfRgbaYca.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <string>

#include "common/base/error.h"

namespace shadowcache {

namespace {

/// Least weight of a primary in the luminance (wide gamuts give a negative one): a texel with light
/// must never count as black, or it would never be sampled.
constexpr float kLeastLuminanceWeight = 0.01f;

/// Chromaticities that differ less, as by rounding, are the same.
constexpr float kChromaticityStep = 1e-3f;

constexpr std::array<float, 8> kRec709{0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};

std::string textOf(const std::array<float, 8>& c) {
    return fmt::format(
        "red {:.4g},{:.4g}, green {:.4g},{:.4g}, blue {:.4g},{:.4g}, white {:.4g},{:.4g}", c[0],
        c[1], c[2], c[3], c[4], c[5], c[6], c[7]);
}

bool isRec709(const std::array<float, 8>& primaries) {
    return std::equal(primaries.begin(), primaries.end(), kRec709.begin(),
                      [](float a, float b) { return std::abs(a - b) < kChromaticityStep; });
}

/// Of red, green and blue; not finite where the primaries make no white.
Vec3f luminancesOf(const std::array<float, 8>& c) {
    try {
        return Imf::RgbaYca::computeYw({{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}});
    } catch (const std::exception&) {
        return Vec3f(std::numeric_limits<float>::quiet_NaN());
    }
}

}  // namespace

void setPrimaries(const std::filesystem::path& path, const std::array<float, 8>& c,
                  RadianceImage& image) {
    const Vec3f yw = luminancesOf(c);
    if (!std::isfinite(yw.x + yw.y + yw.z))
        throwFileError(path,
                       "primaries " + textOf(c) + " have no luminance, expected three colours");
    const Rgb weights(std::max(yw.x, kLeastLuminanceWeight), std::max(yw.y, kLeastLuminanceWeight),
                      std::max(yw.z, kLeastLuminanceWeight));
    image.luminanceWeights = weights / (weights.x + weights.y + weights.z);
    if (isRec709(c)) return;
    image.chromaticities = c;
    image.notes.push_back("primaries are not Rec. 709 but " + textOf(c) +
                          ": pictures have them, and their EXR files say so; colours of the set "
                          "are taken as they are");
}

}  // namespace shadowcache
