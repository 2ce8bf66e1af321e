#pragma once

#include <cstddef>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache {

/// What the numbers of a file's vertex colours may be. They are those of a display (sRGB) in all.
enum class ColorNumbers {
    bytes,  ///< 0 to 255
    whole,  ///< of a wider type: 0 to 255, or 0 to 65535 if one is above 255
    /// Text or floats: 0 to 1, or 0 to 255 if all are whole and one is above 1.
    any,
};

/// Finds out what the numbers of all of a file's colours are, not of each.
class ColorScale {
public:
    explicit ColorScale(ColorNumbers numbers) : numbers_(numbers) {}

    /// Takes a number into account, one that is not a colour's but an opacity's too.
    void see(double value);

    /// The number that stands for full colour: 1, 255 or 65535.
    double full() const;

private:
    ColorNumbers numbers_;
    bool whole_ = true;
    double greatest_ = 0;
};

/// Turns the numbers of a file into linear colours. Numbers out of range are clamped, NaN is 0.
///
/// @return colours that have such a number
std::size_t decodeColors(const ColorScale& scale, std::vector<Rgb>& colors);

/// Number of a colour, or an opacity, from 0 to 1; NaN is 0.
///
/// @param bad  set if it had to be changed
float clampedShare(double value, bool& bad);

}  // namespace shadowcache
