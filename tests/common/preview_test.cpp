// The preview: the irradiance predicted from the counts, item by item.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "common/predict/item_irradiance.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

/// A ball on a floor before a wall, baked down to a level: the base is 0 or 1.
class Preview : public testing::TestWithParam<int> {
protected:
    struct Place {
        std::vector<ItemView> items;  ///< around it
        Vec3f normal;
    };

    TriangleMesh mesh_ = makeMesh();
    Scene scene_{mesh_};
    test::TestCache cache_{bakeOf(scene_, GetParam())};
    DirectionTiers tiers_ = cache_.cache().header().tiers();
    Environment environment_ = test::environmentOf(test::noiseMap(64, 32, 5), 30);
    CachePreview preview_{environment_, tiers_};
    PooledVisibility pooled_{tiers_};
    ItemView item_{};  ///< what pooled_ refers to

    /// Places all over the set, seen from around it.
    std::vector<Place> places() const {
        std::vector<Place> all;
        ShadowCache::Reader reader(cache_.cache());
        std::array<ItemView, ShadowCache::kMaxItems> found;
        for (std::uint32_t cell = 0; cell < cellCount(3); ++cell) {
            const Vec3f outward(cellCenter(3, cell));
            if (outward.y < 0.1f) continue;
            const ShadingPoint point =
                test::pointAlong(scene_, Vec3f(0, 0.5f, 0) + outward * 1.5f, -outward);
            const int count = reader.lookUp(point.place.position, point.place.normal, found);
            all.push_back({{found.begin(), found.begin() + count}, point.place.normal});
        }
        return all;
    }

    /// What pooling foretells, of one item alone or of several.
    Rgb pooled(const ItemView& item, const Vec3f& normal) {
        item_ = item;
        item_.weight = 1;
        return pooled({&item_, 1}, normal);
    }
    Rgb pooled(std::span<const ItemView> items, const Vec3f& normal) {
        pooled_.pool(items);
        return preview_.irradiance(pooled_, normal);
    }

private:
    static TriangleMesh makeMesh() {
        TriangleMesh mesh;
        test::addFloor(mesh, 0, -1, 1, -1, 1);
        test::addBox(mesh, {-1, 0, -1}, {1, 1, -0.9f});
        test::addSphere(mesh, {0, 0.5f, 0}, 0.5f, 12);
        return mesh;
    }
    static BakeResult bakeOf(const Scene& scene, int level) {
        BakeOptions options;
        options.spacing = 0.2;
        options.level = level;
        return bake(scene, options);
    }
};

INSTANTIATE_TEST_SUITE_P(Levels, Preview, testing::Values(4, 5));

/// Root of the summed squares of what differs, over that of what is wanted.
double relativeDifference(const std::vector<Rgb>& found, const std::vector<Rgb>& wanted) {
    double off = 0, all = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        off += static_cast<double>((found[i] - wanted[i]).dot(found[i] - wanted[i]));
        all += static_cast<double>(wanted[i].dot(wanted[i]));
    }
    return std::sqrt(off / all);
}

/// Slope of the line through the origin that fits what is found over what is wanted.
double slopeOf(const std::vector<Rgb>& found, const std::vector<Rgb>& wanted) {
    double product = 0, all = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        product += static_cast<double>(found[i].dot(wanted[i]));
        all += static_cast<double>(wanted[i].dot(wanted[i]));
    }
    return product / all;
}

TEST_P(Preview, OfOneItemIsThatOfThePoolOfIt) {
    std::vector<Rgb> one, pool, another;
    for (const Place& place : places())
        for (const ItemView& item : place.items) {
            one.push_back(preview_.irradianceWithGradient(item, item.normal).value);
            pool.push_back(pooled(item, item.normal));
            another.push_back(pooled(place.items.front(), item.normal));
        }
    ASSERT_GT(one.size(), 500u);
    EXPECT_LT(relativeDifference(one, pool), 1e-5);
    EXPECT_GT(relativeDifference(one, another), 1e-2) << "control: another item's counts";
}

// Over tilts as it is used for. The gradient smooths the horizon, and cells are split at one normal
// and not at another: hence the margin.
TEST_P(Preview, GradientIsThatOfTheIrradiance) {
    constexpr float kStep = 0.3f;
    std::vector<Rgb> predicted, measured, none;
    for (const Place& place : places())
        for (const ItemView& item : place.items) {
            Vec3d s, t;
            tangentFrame(Vec3d(item.normal), s, t);
            const IrradianceWithGradient near = preview_.irradianceWithGradient(item, item.normal);
            for (const Vec3d& tangent : {s, t}) {
                const Vec3f a = (item.normal + Vec3f(tangent) * kStep).normalized();
                const Vec3f b = (item.normal - Vec3f(tangent) * kStep).normalized();
                predicted.push_back(near.at(a - item.normal) - near.at(b - item.normal));
                measured.push_back(pooled(item, a) - pooled(item, b));
                none.emplace_back(0.0f, 0.0f, 0.0f);
            }
        }
    EXPECT_LT(relativeDifference(predicted, measured), 0.15);
    EXPECT_GT(relativeDifference(none, measured), 0.9) << "control: no gradient";
    EXPECT_NEAR(slopeOf(predicted, measured), 1, 0.03);
    for (Rgb& steeper : predicted) steeper *= 1.05f;
    EXPECT_GT(slopeOf(predicted, measured), 1.03) << "control: a gradient 5 % off";
}

TEST_P(Preview, ByItemsIsNearlyThatOfTheirPool) {
    ItemIrradiance byItem(preview_);
    std::vector<Rgb> mean, pool, shifted;
    for (const Place& place : places()) {
        mean.push_back(byItem.mean(place.items, place.normal));
        pool.push_back(pooled(place.items, place.normal));
    }
    shifted.assign(pool.begin() + 1, pool.end());
    shifted.push_back(pool.front());
    EXPECT_LT(relativeDifference(mean, pool), 0.03);
    EXPECT_GT(relativeDifference(shifted, pool), 0.1) << "control: other places";
}

// A rough sum is off by little. Control: it is another one.
TEST_P(Preview, RoughIsNearTheFineOne) {
    const CachePreview rough(environment_, tiers_, 0.2f);
    std::vector<Rgb> found, wanted;
    for (const Place& place : places())
        for (const ItemView& item : place.items) {
            found.push_back(rough.irradiance(item, item.normal));
            wanted.push_back(preview_.irradiance(item, item.normal));
        }
    EXPECT_LT(relativeDifference(found, wanted), 0.05);
    EXPECT_GT(relativeDifference(found, wanted), 1e-4);
}

// What a thread keeps of the items it met changes no bit: neither the order nor other normals do.
TEST_P(Preview, DoesNotDependOnWhatWasMetBefore) {
    const std::vector<Place> all = places();
    ItemIrradiance forward(preview_), backward(preview_);
    for (const Place& place : all)
        backward.mean(place.items, (place.normal + Vec3f(0.3f, 0.3f, 0.1f)).normalized());
    std::vector<Rgb> one(all.size()), two(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) one[i] = forward.mean(all[i].items, all[i].normal);
    for (std::size_t i = all.size(); i-- > 0;) two[i] = backward.mean(all[i].items, all[i].normal);
    EXPECT_TRUE(one == two);
}

}  // namespace
}  // namespace shadowcache
