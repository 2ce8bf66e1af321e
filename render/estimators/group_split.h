#pragma once

#include <span>
#include <utility>

#include "render/estimators/estimator.h"
#include "render/estimators/light_groups.h"

namespace shadowcache {

/// Light of which all is the sky's.
///
/// @param light  of an estimate: its irradiance or radiance
template <class T>
GroupedLight ofSkyAlone(const LightGroups& groups, std::span<const T> estimates, Rgb T::*light) {
    GroupedLight split(estimates.size(), groups.size());
    for (std::size_t i = 0; i < estimates.size(); ++i)
        split[i][LightGroups::kSky] = estimates[i].*light;
    return split;
}

/// What an estimator has just found, by group; empty if its context has no groups.
///
/// @param workspace  that it found it with
template <class T>
GroupedLight splitLight(const EstimatorContext& context, std::span<const T> estimates,
                        Rgb T::*light, Workspace& workspace) {
    if (!context.groups) return {};
    if (!context.emitters) return ofSkyAlone(*context.groups, estimates, light);
    return std::exchange(workspace.groups, {});
}

}  // namespace shadowcache
