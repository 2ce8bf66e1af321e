"""The bundled set, which has textures, is baked and rendered by the module as by the programs."""
from pictures_test import expect_bits_of_the_program, expect_bytes_of_the_program


def test_bake_has_the_bytes_of_the_program(courtyard, tmp_path):
    expect_bytes_of_the_program(courtyard, tmp_path)


def test_render_has_the_bits_of_the_program(courtyard, tmp_path):
    expect_bits_of_the_program(courtyard, tmp_path, {"spp": 4}, ["--spp", 4], True)
