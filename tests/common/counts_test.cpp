// Sums of 8-bit counts.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

#include "common/cache/cache_items.h"

namespace shadowcache {
namespace {

TEST(AddCounts, KeepsMixedMixedAndPureExact) {
    for (unsigned d = 0; d < 256; ++d)
        for (unsigned n = 0; n <= d; n += d > 40 ? 5 : 1)
            for (const auto& [moreN, moreD] : {std::array{0u, 1u},
                                               {1u, 1u},
                                               {0u, 255u},
                                               {255u, 255u},
                                               {1u, 255u},
                                               {254u, 255u},
                                               {0u, 65000u},
                                               {65000u, 65000u},
                                               {1u, 65000u},
                                               {64999u, 65000u},
                                               {7u, 16u}}) {
                std::uint8_t sumN = static_cast<std::uint8_t>(n),
                             sumD = static_cast<std::uint8_t>(d);
                addCounts(sumN, sumD, moreN, moreD);
                const unsigned trueN = n + moreN, trueD = d + moreD;
                EXPECT_LE(sumN, sumD);
                EXPECT_GT(sumD, 0);
                EXPECT_EQ(sumN == 0, trueN == 0) << n << "/" << d << " " << moreN << "/" << moreD;
                EXPECT_EQ(sumN == sumD, trueN == trueD)
                    << n << "/" << d << " " << moreN << "/" << moreD;
                // To the eighth bit the ratio stays.
                EXPECT_NEAR(static_cast<double>(sumN) / sumD, static_cast<double>(trueN) / trueD,
                            1.0 / 127);
                if (trueD <= 255) {
                    EXPECT_EQ(sumN, trueN);
                    EXPECT_EQ(sumD, trueD);
                }
            }
}

}  // namespace
}  // namespace shadowcache
