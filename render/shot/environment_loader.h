#pragma once

#include <memory>
#include <string>

#include "common/light/environment.h"
#include "render/shot/light_plan.h"

namespace shadowcache {

/// Loads the environment of each frame of a plan; a map that consecutive frames share is read and
/// tabulated once.
class EnvironmentLoader {
public:
    explicit EnvironmentLoader(const LightPlan& plan);

    /// Loads the environment of the plan's light i, unless it is loaded already.
    ///
    /// @return whether environment() changed
    /// @throws Error if the map cannot be read
    bool load(std::size_t i);
    const Environment& environment() const { return *environment_; }

private:
    const LightPlan& plan_;
    LightPlan::Light current_;
    std::unique_ptr<Environment> environment_;
};

}  // namespace shadowcache
