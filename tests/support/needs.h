#pragma once

#include <gtest/gtest.h>

#include <cstdlib>

/// Skips the test where `tool` is not installed, that is, where the shell command `has` fails. If
/// SHADOWCACHE_NO_SKIP is set the test fails: CI installs every tool. All are string literals.
#define SHADOWCACHE_NEEDS(tool, has)                                         \
    do {                                                                     \
        if (std::system("{ " has "; } > /dev/null 2>&1") != 0) {             \
            if (std::getenv("SHADOWCACHE_NO_SKIP")) FAIL() << "needs " tool; \
            GTEST_SKIP() << "needs " tool;                                   \
        }                                                                    \
    } while (false)
