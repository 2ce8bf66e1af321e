// A cluster of points with one set-up: what is drawn, and what is integrated, for each of them.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "render/cached/cluster_sampler.h"
#include "render/cached/point_clusters.h"
#include "render/regions/cosine_integrand.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

/// Points around a place beside a ball, whose normals differ, under noise with a small sun.
class Cluster : public testing::Test {
protected:
    static constexpr int kPoints = 24;

    Cluster() {
        ShadowCache::Reader reader(cache_.cache());
        const ShadingPoint centre = test::pointAlong(scene_, {0.45f, 1, 0.2f}, {0, -1, 0});
        const int found = reader.lookUp(centre.place.position, centre.place.normal, items_);
        pooled_.pool(std::span(items_).first(static_cast<std::size_t>(found)));
        for (int i = 0; i < kPoints; ++i) {
            ShadingPoint& point = points_.emplace_back(centre);
            const double angle = 2 * kPi * i / kPoints;
            const double tilt = static_cast<double>(kTilt);
            const Vec3d lean(tilt * std::cos(angle), 0, tilt * std::sin(angle));
            if (i > 0) point.place.normal = Vec3f((Vec3d(centre.place.normal) + lean).normalized());
            point.slot.pixel = static_cast<std::uint32_t>(i / 4);
            point.slot.cameraRay = point.slot.row = static_cast<std::uint32_t>(i % 4);
        }
        members_.resize(kPoints);
        std::iota(members_.begin(), members_.end(), 0u);
        fitted_ = build(kTilt, 0);
        shares_ = RegionSharer().share(fitted_.regions, 64, {0, 0.4}, 0.045);
        distribution_.assign(fitted_.regions, shares_);
    }

    /// Regions around the first point.
    const FittedRegions<CosineIntegrand>& build(float tilt, float leastNoise) {
        return builder_.build(
            CosineIntegrand(environment_, splitter_, points_[0].place.normal, tilt, leastNoise),
            pooled_, Calibration());
    }

    std::span<const ClusterSample> draw(double share, std::uint64_t seed) {
        for (ShadingPoint& point : points_) point.slot.seed = hashWords(seed, 5, point.slot.pixel);
        const PointBatch batch{points_, 1, kPoints / 4, 4};
        std::vector<double> wanted;
        for (const ShadingPoint& point : points_)
            wanted.push_back(share * static_cast<double>(point.slot.sampleFraction));
        roundCounts(wanted, toUnit(hashWords(seed)), counts_);
        return sampler_.draw(batch, members_, counts_, distribution_, Sequence::kSobol);
    }

    /// Control variate's value along a sample's direction, for its point.
    double stoodIn(const ClusterSample& sample, const EnvironmentSample& s) const {
        const CosineIntegrand::Fit& fit = fitted_.fits[sample.place.group];
        const auto x = static_cast<double>(s.direction.dot(points_[sample.member].place.normal));
        const int i = sample.place.lane;
        return static_cast<double>(shares_.groups[sample.place.group].visibility[i]) *
               (static_cast<double>(fit.constant[i]) +
                x * (static_cast<double>(fit.linear[i]) + x * static_cast<double>(fit.square[i])));
    }

    static constexpr float kTilt = 0.6f;
    static constexpr float kNoSplits = std::numeric_limits<float>::max();

    /// Lit texels above the horizon of some point that no region covers.
    int missed(const Regions& regions) const {
        std::map<std::pair<int, std::uint32_t>, bool> has;
        for (const RegionGroup& group : regions.groups)
            for (std::uint32_t i = 0; i < kBlockCells; ++i)
                if (group.light[i] > 0) has[{group.level, group.firstCell + i}] = true;
        int count = 0;
        for (std::uint32_t cell = 0; cell < cellCount(Environment::kLevel); ++cell) {
            bool covered = false;
            for (int level = 0; level <= Environment::kLevel; ++level)
                covered |= has.count({level, ancestorCell(cell, Environment::kLevel, level)}) > 0;
            environment_.forEachTexel(cell, [&](std::uint32_t i) {
                if (!(environment_.luminance(environment_.texel(i).radiance) > 0)) return;
                const Vec3f direction(environment_.placeIn(i, 0.9, 0.9));
                count += !covered && std::ranges::any_of(points_, [&](const ShadingPoint& p) {
                    return direction.dot(p.place.normal) > 0;
                });
            });
        }
        return count;
    }

private:
    static TriangleMesh makeMesh() {
        TriangleMesh mesh;
        test::addFloor(mesh, 0, -1, 1, -1, 1);
        test::addSphere(mesh, {0, 0.5f, 0}, 0.4f, 12);
        return mesh;
    }
    static BakeResult bakeOf(const Scene& scene) {
        BakeOptions options;
        options.spacing = 0.25;
        return bake(scene, options);
    }
    static Image makeMap() {
        Image map = test::noiseMap(64, 32, 5);
        const auto [x, y] = test::texelAt(64, 32, Vec3d(0.5, 0.8, 0.2).normalized());
        map.pixels[static_cast<std::size_t>(y * 64 + x)] = Rgb(1e3f, 1e3f, 1e3f);
        return map;
    }

    TriangleMesh mesh_ = makeMesh();
    Scene scene_{mesh_};
    test::TestCache cache_{bakeOf(scene_)};

protected:
    Environment environment_ = test::environmentOf(makeMap());
    std::array<ItemView, ShadowCache::kMaxItems> items_{};
    PooledVisibility pooled_{cache_.cache().header().tiers()};
    std::vector<ShadingPoint> points_;
    std::vector<std::uint32_t> members_;
    CellSplitter splitter_{environment_, pooled_.tiers()};
    RegionBuilder<CosineIntegrand> builder_{environment_, pooled_.tiers()};
    FittedRegions<CosineIntegrand> fitted_;
    RegionShares shares_;
    RegionDistribution distribution_{environment_};
    std::vector<SampleCount> counts_;
    ClusterSampler sampler_{environment_};
};

constexpr std::array<double, 5> kShares{0.3, 1, 2.5, 16, 64};

// A point gets its share, rounded up or down, and the cluster's total is that of all shares.
TEST_F(Cluster, PointsGetTheirShares) {
    for (const double share : kShares) {
        constexpr int kDraws = 2000;
        std::array<double, kPoints> sum{};
        for (int k = 0; k < kDraws; ++k) {
            draw(share, static_cast<std::uint64_t>(k));
            double all = 0;
            for (std::size_t i = 0; i < counts_.size(); ++i) {
                EXPECT_LT(std::abs(counts_[i].drawn - share), 1);
                EXPECT_EQ(counts_[i].divisor, share < 1 ? share : counts_[i].drawn);
                EXPECT_EQ(counts_[i].expected, share);
                sum[i] += counts_[i].drawn;
                all += counts_[i].drawn;
            }
            EXPECT_LT(std::abs(all - share * kPoints), 1);
        }
        for (const double s : sum) EXPECT_NEAR(s / kDraws, share, 6 * 0.5 / std::sqrt(kDraws));
    }
}

// Points of pixels with more camera rays get as many fewer samples each.
TEST_F(Cluster, PointsGetPartsOfTheirShares) {
    constexpr int kDraws = 4000;
    for (const double share : kShares) {
        std::array<double, kPoints> sum{};
        double total = 0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            points_[i].slot.sampleFraction = i % 3 == 0 ? 0.25f : 1;
            total += share * static_cast<double>(points_[i].slot.sampleFraction);
        }
        for (int k = 0; k < kDraws; ++k) {
            draw(share, static_cast<std::uint64_t>(k));
            double all = 0;
            for (std::size_t i = 0; i < counts_.size(); ++i) {
                const double part = share * static_cast<double>(points_[i].slot.sampleFraction);
                EXPECT_LT(std::abs(counts_[i].drawn - part), 1);
                EXPECT_EQ(counts_[i].divisor, part < 1 ? part : counts_[i].drawn);
                EXPECT_EQ(counts_[i].expected, part);
                sum[i] += counts_[i].drawn;
                all += counts_[i].drawn;
            }
            EXPECT_LT(std::abs(all - total), 1);
        }
        for (std::size_t i = 0; i < points_.size(); ++i)
            EXPECT_NEAR(sum[i] / kDraws,
                        share * static_cast<double>(points_[i].slot.sampleFraction),
                        6 * 0.5 / std::sqrt(kDraws));
    }
}

// Estimates divide by these numbers. The control is their own tolerance: five per cent of the
// most frequent region's number is more than it.
TEST_F(Cluster, RegionsGetTheirSharesOfEachPoint) {
    constexpr int kDraws = 3000;
    for (const double share : kShares) {
        std::map<std::pair<std::uint32_t, int>, double> ofAll, ofLast;
        for (int k = 0; k < kDraws; ++k)
            for (const ClusterSample& sample : draw(share, static_cast<std::uint64_t>(k))) {
                const std::pair region(sample.place.group, sample.place.lane);
                ofAll[region] += 1;
                if (sample.member == kPoints - 1) ofLast[region] += 1;
            }
        double most = 0;
        for (std::uint32_t g = 0; g < shares_.groups.size(); ++g)
            for (int i = 0; i < kBlockCells; ++i) {
                const double chance =
                    static_cast<double>(shares_.groups[g].weight[i]) / shares_.weightSum;
                const std::pair region(g, i);
                if (chance == 0) {
                    EXPECT_EQ(ofAll.count(region), 0u);
                    continue;
                }
                const double wanted = chance * share * kDraws;
                EXPECT_NEAR(ofAll[region], wanted * kPoints, 6 * std::sqrt(wanted * kPoints) + 6);
                EXPECT_NEAR(ofLast[region], wanted, 6 * std::sqrt(wanted) + 6);
                most = std::max(most, wanted * kPoints);
            }
        if (share >= 16) {
            EXPECT_GT(0.05 * most, 6 * std::sqrt(most)) << "the test is blind";
        }
    }
}

// One sequence for all: the samples of a cluster fall into the regions much more evenly than by
// chance alone. Control: points with sequences of their own.
TEST_F(Cluster, SamplesAreStratifiedOverAllPoints) {
    const auto varianceOf = [&](bool together) {
        constexpr int kDraws = 200;
        std::map<std::uint32_t, double> sum, sum2;
        for (std::uint64_t k = 0; k < kDraws; ++k) {
            std::map<std::uint32_t, double> count;
            if (together) {
                for (const ClusterSample& s : draw(16, k)) ++count[s.place.group];
            } else {
                for (std::size_t i = 0; i < points_.size(); ++i) {
                    draw(16, k);  // for the seeds and shares
                    const std::span<const std::uint32_t> one(&members_[i], 1);
                    for (const ClusterSample& s : sampler_.draw({points_, 1, kPoints / 4, 4}, one,
                                                                std::span(counts_).subspan(i, 1),
                                                                distribution_, Sequence::kSobol))
                        ++count[s.place.group];
                }
            }
            for (const auto& [group, n] : count) sum[group] += n, sum2[group] += n * n;
        }
        double variance = 0;
        for (const auto& [group, s] : sum)
            variance += sum2[group] / kDraws - (s / kDraws) * (s / kDraws);
        return variance;
    };
    EXPECT_LT(varianceOf(true), 0.25 * varianceOf(false));
}

// Every direction above the horizon of any point lies in a region, whatever is split. Control:
// regions of the centre's normal alone miss some.
TEST_F(Cluster, CoversTheHorizonsOfAllPoints) {
    EXPECT_EQ(missed(fitted_.regions), 0);
    EXPECT_EQ(missed(build(kTilt, kNoSplits).regions), 0);
    EXPECT_GT(missed(build(0, 0).regions), 20);
}

// The more noise keeps a cell whole, the fewer regions there are and the more a sample deviates.
TEST_F(Cluster, FewerSplitsMakeFewerAndNoisierRegions) {
    const auto sky = static_cast<float>(environment_.luminanceIntegral());
    std::vector<std::size_t> groups;
    std::vector<double> deviations;
    for (const float share : {0.0f, 2e-3f, 2e-2f, 1.0f}) {
        const Regions& regions = build(0, share * sky).regions;
        groups.push_back(regions.groups.size());
        deviations.push_back(regions.deviationSum);
    }
    EXPECT_TRUE(std::ranges::is_sorted(groups, std::greater()));
    EXPECT_TRUE(std::ranges::is_sorted(deviations));
    EXPECT_GT(groups.front(), 3 * groups.back());
    EXPECT_GT(deviations.back(), 1.01 * deviations.front());
    // Control: the splitter's own noise counts where it is more.
    EXPECT_EQ(build(0, 1e-6f * sky).regions.groups.size(), groups.front());
}

// Splits that lower the deviation by half pay for less noise than those that lower it by a tenth.
TEST(SplitNoise, IsLessWhereSplitsGain) {
    EXPECT_NEAR(splitNoise(1, 2) / splitNoise(1.8, 2), 1.0 / 9, 1e-9);
    EXPECT_NEAR(splitNoise(3, 6), 3 * splitNoise(1, 2), 1e-9);
    EXPECT_EQ(splitNoise(0, 0), 0);
    EXPECT_GT(splitNoise(2, 2), 100 * splitNoise(1, 2));
    EXPECT_TRUE(std::isfinite(splitNoise(2, 2)));
}

// The polynomial's integral for a point's own normal is the mean of what samples subtract. With its
// control: 3 % more is rejected.
TEST_F(Cluster, IntegralIsWhatSamplesSubtract) {
    const CosineIntegral predicted(environment_, fitted_, shares_);
    for (const std::uint32_t point : {0u, 5u, 17u}) {
        constexpr int kDraws = 6000;
        std::vector<double> values;
        for (std::uint64_t k = 0; k < kDraws; ++k) {
            double sum = 0;
            for (const ClusterSample& sample : draw(16, k)) {
                if (sample.member != point) continue;
                const EnvironmentSample s = sample.finish(environment_);
                sum += static_cast<double>(s.radiance.y * sample.inverseCount / s.density) *
                       stoodIn(sample, s);
            }
            values.push_back(sum);
        }
        const auto integral = static_cast<double>(predicted.at(points_[point].place.normal).y);
        EXPECT_GT(test::meanPValue(values, integral), test::significance(3));
        EXPECT_LT(test::meanPValue(values, integral * 1.03), test::significance(3));
    }
}

// The same across the horizon alone, of all points together. With its control: 2 % more is
// rejected.
TEST_F(Cluster, IntegralAcrossTheHorizonIsWhatSamplesSubtract) {
    std::size_t cut = 0;
    for (std::size_t g = 0; g < shares_.groups.size(); ++g)
        for (int i = 0; i < kBlockCells; ++i) {
            const bool across = fitted_.fits[g].constant[i] != 0;
            if (!across) shares_.groups[g].visibility[i] = 0;
            cut += across && shares_.groups[g].visibility[i] > 0;
        }
    EXPECT_GT(cut, 20u);
    const CosineIntegral predicted(environment_, fitted_, shares_);
    double integral = 0;
    for (const ShadingPoint& point : points_)
        integral += static_cast<double>(predicted.at(point.place.normal).y);
    constexpr int kDraws = 4000;
    std::vector<double> values;
    for (std::uint64_t k = 0; k < kDraws; ++k) {
        double sum = 0;
        for (const ClusterSample& sample : draw(64, k)) {
            if (fitted_.fits[sample.place.group].constant[sample.place.lane] == 0) continue;
            const EnvironmentSample s = sample.finish(environment_);
            sum += static_cast<double>(s.radiance.y * sample.inverseCount / s.density) *
                   stoodIn(sample, s);
        }
        values.push_back(sum);
    }
    EXPECT_GT(test::meanPValue(values, integral), test::significance(1));
    EXPECT_LT(test::meanPValue(values, integral * 1.02), test::significance(1));
}

TEST(PointClusters, HoldEveryPointOnceAndOnlyAlikeOnes) {
    std::vector<ShadingPoint> points;
    for (std::uint32_t i = 0; i < 3000; ++i) {
        ShadingPoint& p = points.emplace_back();
        const double angle = 4 * kPi * toUnit(hashWords(i, 1)), x = 5 * toUnit(hashWords(i, 2));
        p.place.position = Vec3d(x, std::sin(angle), std::cos(angle));
        p.place.normal = Vec3f(Vec3d(0, std::sin(angle), std::cos(angle)));
    }
    PointClusters clusters;
    const std::span<const PointCluster> fine = clusters.build(points, 0.5, 1, 1);
    std::vector<int> seen(points.size());
    EXPECT_LT(fine.size(), points.size() / 3);
    for (const PointCluster& c : fine) {
        EXPECT_LT(c.tilt, 0.75f);
        EXPECT_LT(c.radius, 1.3f);
        EXPECT_TRUE(std::ranges::is_sorted(c.members, std::less_equal<>()));
        for (const std::uint32_t point : c.members) {
            ++seen[point];
            EXPECT_LE(points[point].place.normal.cross(points[c.centre].place.normal).length(),
                      c.tilt);
        }
    }
    EXPECT_EQ(std::ranges::count(seen, 1), static_cast<std::ptrdiff_t>(points.size()));
    // With more camera rays a pixel, clusters have more points.
    const std::size_t ofOneRay = fine.size();
    EXPECT_LT(clusters.build(points, 0.5, 64, 1).size(), ofOneRay * 4 / 5);
    // With more samples a point, fewer.
    EXPECT_GT(clusters.build(points, 0.5, 1, 64).size(), ofOneRay * 5 / 4);
    // Points that all coincide are one cluster, however many.
    const std::vector<ShadingPoint> same(500, points[0]);
    EXPECT_EQ(clusters.build(same, 0.5, 1, 1).size(), 1u);
}

}  // namespace
}  // namespace shadowcache
