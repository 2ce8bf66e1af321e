#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/image/image.h"
#include "render/shot/light_rotation.h"

namespace shadowcache {

/// The light of a job, as its command line has it.
struct LightOptions {
    /// Empty: a black sky. Else a file, one radiance R,G,B, files joined by commas, one for each
    /// frame, or a sequence whose
    /// #### or %04d is the frame's number.
    std::string environment;
    std::string rotation = "0";  ///< as parseRotation() reads it
    std::string gain = "1";      ///< a factor of the radiance, or three R,G,B
};

/// Which light falls on each frame of a job: a map or one radiance, how it is turned, and how
/// strong it is.
class LightPlan {
public:
    struct Light {
        std::string environment;  ///< a file, or "R,G,B"
        LightRotation rotation;
        Vec3d gain{1, 1, 1};
        bool operator==(const Light&) const = default;
    };

    /// @param shot  frames of the whole shot, of which `frames` are some: maps and turn go over it;
    ///              empty: `frames`
    /// @throws Error if an option is malformed, the number of maps is not that of the shot's
    /// frames,
    ///         or a frame is none of the shot's
    LightPlan(const LightOptions& options, std::span<const int> frames,
              std::span<const int> shot = {});

    /// Light of frames[i].
    const Light& at(std::size_t i) const { return lights_[i]; }

    /// @throws Error naming the first file that is missing
    void requireFiles() const;

private:
    std::vector<Light> lights_;
};

/// A factor, or three R,G,B joined by commas.
///
/// @throws Error on other texts, and on numbers out of range
Vec3d gainOf(const std::string& text);

/// "R,G,B" -> one colour. @throws Error on radiances below 0
std::optional<Rgb> parseRadiance(const std::string& text);

}  // namespace shadowcache
