#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/light/environment.h"
#include "render/shot/light_plan.h"

namespace shadowcache {

/// What is said of what is read.
enum class NoteKind {
    note,    ///< what reading it found, chose or mended
    warning  ///< what is likely to be a mistake
};

/// Has lines for people.
using NoteSink = std::function<void(const std::string& text, NoteKind kind)>;

/// Loads one environment after another; a map is read and tabulated anew only where it is another
/// file, or has been written since.
class EnvironmentLoader {
public:
    /// @param note  has lines for people
    explicit EnvironmentLoader(NoteSink note);

    /// Loads an environment, unless it is loaded already.
    ///
    /// @return whether environment() changed
    /// @throws Error if the map cannot be read; then, and once interrupted, there is no environment
    bool load(const LightPlan::Light& light);

    /// Whether load() has succeeded.
    bool isLoaded() const { return environment_ != nullptr; }
    const Environment& environment() const { return *environment_; }
    /// Primaries of the loaded map, if they are not Rec. 709 (RadianceImage::chromaticities).
    const std::optional<std::array<float, 8>>& chromaticities() const { return chromaticities_; }

private:
    using Time = std::filesystem::file_time_type;

    void turn(const LightPlan::Light& light);

    NoteSink note_;
    LightPlan::Light current_;
    std::optional<Time> written_;  ///< the map's file
    std::unique_ptr<Environment> environment_;
    std::optional<std::array<float, 8>> chromaticities_;
};

}  // namespace shadowcache
