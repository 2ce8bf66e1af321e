#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/image/image.h"

namespace shadowcache {

/// Which light falls on each frame of a job: a map or one radiance, and how far it is turned.
class LightPlan {
public:
    struct Light {
        std::string environment;  ///< a file, or "R,G,B"
        double rotation = 0;      ///< [degrees]
        bool operator==(const Light&) const = default;
    };

    /// `environments` is a file, one radiance R,G,B, files joined by commas, one for each frame, or
    /// a sequence whose #### or %04d is the frame's number. `rotation` is an angle, or A-B: from A
    /// in the first frame to B in the last.
    ///
    /// @param shot  frames of the whole shot, of which `frames` are some: the first and last above
    ///              are its; empty: `frames`
    /// @throws Error if either is malformed, the number of maps is not that of the shot's frames,
    ///         or a frame is none of the shot's
    LightPlan(const std::string& environments, const std::string& rotation,
              std::span<const int> frames, std::span<const int> shot = {});

    /// Light of frames[i].
    const Light& at(std::size_t i) const { return lights_[i]; }

    /// @throws Error naming the first file that is missing
    void requireFiles() const;

private:
    std::vector<Light> lights_;
};

/// "R,G,B" -> one colour. @throws Error on radiances below 0
std::optional<Rgb> parseRadiance(const std::string& text);

}  // namespace shadowcache
