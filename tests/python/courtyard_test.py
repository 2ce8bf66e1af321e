"""The bundled set, which has textures, is baked and rendered by the module as by the programs."""
import numpy as np
from pictures_test import expect_bits_of_the_program, expect_bytes_of_the_program

import shadowcache


def test_bake_has_the_bytes_of_the_program(courtyard, tmp_path):
    expect_bytes_of_the_program(courtyard, tmp_path)


def test_render_has_the_bits_of_the_program(courtyard, tmp_path):
    expect_bits_of_the_program(courtyard, tmp_path, {"spp": 4}, ["--spp", 4], True)


def test_the_next_camera_finds_the_light_predicted(courtyard):
    """The light of a scene and sky is predicted once; the pictures are those of a cache that knows nothing.

    The set is large: what takes less than a tenth of a second reports no progress.
    """
    skies = [shadowcache.Environment.constant((1, 2, 3)), shadowcache.Environment.constant((3, 2, 1))]
    kept = shadowcache.Cache.open(courtyard.cache)

    def render(cache, frame=9, sky=skies[0], **options):
        tasks = []
        camera = shadowcache.Camera.load(courtyard.camera, frame=frame)
        color = shadowcache.render(courtyard.scene, cache, sky, camera, size=(16, 9), spp=2, **options,
                                   progress=lambda task, *_: tasks.append(task))["color"]
        return color, "predict light" in tasks

    begin = render(kept, 2)
    # One thing of the light more at a time; a camera and a seed are none of it.
    red, more = {"sky": skies[1]}, {"sky": skies[1], "bounces": 2}
    for predicts, options in ((False, {"seed": 3}), (True, red), (True, more), (True, {**more, "albedo": 0.2}),
                              (False, {**more, "albedo": 0.2, "frame": 2})):
        color, predicted = render(kept, **options)
        alone, always = render(shadowcache.Cache.open(courtyard.cache), **options)
        assert np.array_equal(color, alone) and always and predicted == predicts, options
    end = render(kept, 2)
    assert begin[1] and end[1] and np.array_equal(begin[0], end[0])
