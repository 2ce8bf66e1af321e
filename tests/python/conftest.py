"""What tests of the module share; a file that wants others has its own of the same name."""
import pytest

import shadowcache
import small_set


@pytest.fixture(scope="session")
def scene():
    return shadowcache.load_set(small_set.VERTICES, small_set.TRIANGLES)


@pytest.fixture(scope="session")
def cache(scene):
    return shadowcache.bake(scene, spacing=0.25, level=3)


@pytest.fixture(scope="session")
def white():
    return shadowcache.Environment.constant(1)


@pytest.fixture(scope="session")
def sunrise():
    """The bundled map as its file has it."""
    return shadowcache.Environment.load(small_set.MAP)


@pytest.fixture(scope="session")
def camera():
    return shadowcache.Camera(eye=(3, 2, 4), look_at=(0, 0.3, 0), fov=40)


@pytest.fixture(scope="session")
def courtyard(tmp_path_factory):
    return small_set.courtyard(tmp_path_factory.mktemp("courtyard"))


@pytest.fixture(scope="session")
def small(tmp_path_factory):
    return small_set.small(tmp_path_factory.mktemp("small"))
