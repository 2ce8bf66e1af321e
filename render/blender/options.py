# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of a scene as the request options has them."""

from .option_table import values_of


def options_of(scene, camera_rays, samples, aovs=(), pass_rays=None, is_hybrid=False, groups=()):
    """camera_rays: of a pixel; None: as many as the noise target needs. is_hybrid: light that bounces is not asked for.
    groups: of light_groups.rules_of()."""
    options = {**values_of(scene.shadowcache), "samples": samples, "aov": list(aovs),
               "transparent": scene.render.film_transparent}
    if camera_rays is None:
        del options["camera-rays"]
    else:
        del options["target-error"]
        options["camera-rays"] = camera_rays
    if groups:
        options["light-groups"] = list(groups)
    if is_hybrid:
        options["bounces"] = 0
    if pass_rays:
        options["pass-rays"] = pass_rays
    return options
