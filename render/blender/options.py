# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of a scene as the request options has them."""


def options_of(scene, camera_rays, samples, aovs=(), pass_rays=None, is_hybrid=False):
    """camera_rays: of a pixel; None: as many as the noise target needs. is_hybrid: light that bounces is not asked for."""
    s = scene.shadowcache
    bounces = 0 if is_hybrid else s.bounces
    rays = {"target-error": s.target_error} if camera_rays is None else {"camera-rays": camera_rays}
    options = {**rays, "samples": samples, "bounces": bounces, "seed": s.seed,
               "filter": s.filter, "filter-width": s.filter_width, "aov": list(aovs),
               "transparent": scene.render.film_transparent}
    if pass_rays:
        options["pass-rays"] = pass_rays
    if s.clamp_indirect:
        options["clamp-indirect"] = s.clamp_indirect
    return options
