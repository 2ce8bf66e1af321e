// Light that bounces in a room: against brute force, whatever the surfaces and the cache, and the
// same bits in any parts.

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "common/random/salts.h"
#include "common/shot/view.h"
#include "render/frame/frame_loop.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "render/frame/progressive.h"
#include "render/table/estimator_table.h"
#include "tests/support/brute_force_paths.h"
#include "tests/support/solved.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

using test::Solved;

/// Without bright spots, that brute force would miss.
Image sky() {
    return test::gradientMap(32, 16, {0.3, 0.6, 0.4});
}

/// A room with a window, a box in it, and materials; from an eye inside.
class Room : public testing::Test {
protected:
    static constexpr int kWidth = 24, kHeight = 16;

    Room() {
        test::addFloor(mesh_, 0, -2, 2, -2, 2);
        test::addFloor(mesh_, 2, -2, 2, -2, 2);
        test::addQuad(mesh_, {-2, 0, -2}, {-2, 2, -2}, {-2, 2, 2}, {-2, 0, 2});
        test::addQuad(mesh_, {-2, 0, -2}, {2, 0, -2}, {2, 2, -2}, {-2, 2, -2});
        test::addQuad(mesh_, {2, 0, -2}, {2, 2, -2}, {2, 2, -0.5f}, {2, 0, -0.5f});
        test::addBox(mesh_, {-0.8f, 0, -0.6f}, {0.1f, 0.8f, 0.4f});
    }

    /// One part of the triangles from `first` on for each material.
    void setMaterials(std::vector<std::pair<std::uint32_t, Material>> parts) {
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const std::uint32_t end = i + 1 < parts.size()
                                          ? parts[i + 1].first
                                          : static_cast<std::uint32_t>(mesh_.triangles.size());
            mesh_.materials.push_back(parts[i].second);
            mesh_.parts.push_back({parts[i].first, end - parts[i].first, static_cast<int>(i)});
        }
    }

    static Camera camera() { return lookAt({1.5, 1.2, 1.4}, {0.2, 0.75, 0.2}, {0, 1, 0}, 1.1); }

    static RenderOptions optionsOf(int bounces) {
        RenderOptions options;
        options.width = kWidth;
        options.height = kHeight;
        options.filter = FilterKind::box;
        options.cameraRays = 16;
        options.samples = 4;
        options.bounces = bounces;
        return options;
    }

    /// Mean colour of the film for each of the seeds 1 .. count.
    test::Estimates films(const EstimatorContext& context, const std::string& name,
                          const RenderOptions& wanted, int count) const {
        const auto estimator = findEstimator(name).make(context, {});
        FrameRequest frame{*estimator, camera(), 1, wanted};
        RenderStats stats;
        frame.options.seed = 1000;
        frame.plan = planFrame(frame, stats);
        test::Estimates found;
        for (int seed = 1; seed <= count; ++seed) {
            frame.options.seed = static_cast<std::uint64_t>(seed);
            std::array<double, 3> sum{};
            for (const Pixel& pixel : render(frame, stats).pixels)
                for (std::size_t c = 0; c < 3; ++c)
                    sum[c] += static_cast<double>(pixel.color[static_cast<int>(c)]);
            for (std::size_t c = 0; c < 3; ++c)
                found.color[c].push_back(sum[c] / (kWidth * kHeight));
        }
        return found;
    }

    /// The same by brute force.
    std::array<std::vector<double>, 3> truths(const Scene& scene, const Environment& environment,
                                              const PlainLook& plain, int bounces, int paths,
                                              int count) const {
        const CameraRays rays(camera(), static_cast<double>(kWidth) / kHeight);
        std::array<std::vector<double>, 3> found;
        for (int seed = 1; seed <= count; ++seed) {
            std::vector<Rgb> parts(static_cast<std::size_t>(kWidth * kHeight));
            parallelFor(parts.size(), 16, [&](const Chunk& chunk) {
                for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                    Vec3d sum(0);
                    const std::size_t column = i % kWidth, row = i / kWidth;
                    for (int k = 0; k < paths; ++k) {
                        const std::uint64_t key = hashWords(static_cast<std::uint64_t>(seed) + 7000,
                                                            i, static_cast<std::uint64_t>(k));
                        const FilmPosition at{
                            (static_cast<double>(column) + toUnit(hashWords(key, 1))) / kWidth,
                            (static_cast<double>(row) + toUnit(hashWords(key, 2))) / kHeight};
                        const CameraRay ray = rays.through(at);
                        sum += Vec3d(test::pathRadiance(scene, environment, plain,
                                                        startIn(scene, ray), Vec3f(ray.direction),
                                                        bounces, hashWords(key, 3)));
                    }
                    parts[i] = Rgb(sum / static_cast<double>(paths));
                }
            });
            Vec3d sum(0);
            for (const Rgb& part : parts) sum += Vec3d(part);
            for (std::size_t c = 0; c < 3; ++c)
                found[c].push_back(sum[static_cast<int>(c)] / (kWidth * kHeight));
        }
        return found;
    }

    /// Fails unless the pictures have the brute force's mean, and `factor` times as much is seen.
    void expectSameMean(const test::Estimates& found,
                        const std::array<std::vector<double>, 3>& truths, double level,
                        double factor = 1.02) const {
        double least = 1, leastOfControl = 1;
        for (std::size_t c = 0; c < 3; ++c) {
            std::vector<double> more = found.color[c];
            for (double& value : more) value *= factor;
            least = std::min(least, test::sameMeanPValue(found.color[c], truths[c]));
            leastOfControl = std::min(leastOfControl, test::sameMeanPValue(more, truths[c]));
        }
        EXPECT_GT(3 * least, level);
        EXPECT_LT(3 * leastOfControl, level) << factor << " times as much is accepted";
    }

    TriangleMesh mesh_;
};

/// All that a glTF set's surfaces can do, on the room's parts.
std::vector<std::pair<std::uint32_t, Material>> manyMaterials() {
    Material red, varnish, brass, veil, lamp, oneSided;
    red.albedo = Rgb(0.8f, 0.2f, 0.1f);
    varnish.albedo = Rgb(0.3f, 0.5f, 0.7f);
    varnish.finish.gloss = Gloss{.roughness = 0.3f};
    brass.albedo = Rgb(0.9f, 0.7f, 0.3f);
    brass.finish.gloss = Gloss{.metallic = 1, .roughness = 0.4f};
    veil.albedo = Rgb(0.6f);
    veil.blends = true;
    veil.opacity = 0.5f;
    lamp.albedo = Rgb(0.4f);
    lamp.finish.emission = Rgb(0.3f, 0.2f, 0.1f);
    oneSided.albedo = Rgb(0.7f);
    oneSided.doubleSided = false;
    // Floor, ceiling, wall, back wall, wall by the window, box.
    return {{0, red}, {2, oneSided}, {4, varnish}, {6, lamp}, {8, veil}, {10, brass}};
}

/// The same room with coloured glass in its window, and a lamp behind a smaller pane.
std::vector<std::pair<std::uint32_t, Material>> glazedMaterials(TriangleMesh& mesh) {
    Material plain, glass, lamp, shade;
    plain.albedo = Rgb(0.6f);
    glass.albedo = Rgb(0.3f, 0.8f, 0.6f);
    glass.finish.gloss = Gloss{.metallic = 0, .roughness = 0.1f};
    glass.finish.transmission = 0.9f;
    shade = glass;
    shade.albedo = Rgb(0.9f, 0.5f, 0.2f);
    lamp.albedo = Rgb(0.4f);
    lamp.finish.emission = Rgb(2);
    const auto first = static_cast<std::uint32_t>(mesh.triangles.size());
    test::addQuad(mesh, {2, 0, -0.5f}, {2, 2, -0.5f}, {2, 2, 2}, {2, 0, 2});
    test::addFloor(mesh, 1.9f, -1.5f, -0.5f, -1.5f, -0.5f);
    test::addFloor(mesh, 1.7f, -1.6f, -0.4f, -1.6f, -0.4f);
    return {{0, plain}, {first, glass}, {first + 2, lamp}, {first + 4, shade}};
}

enum class Looks { plain, many, glazed };

struct Set {
    std::string name;
    Looks looks;
    std::string estimator;
    bool solved;
};

class RoomBy : public Room, public testing::WithParamInterface<Set> {};

TEST_P(RoomBy, HasTheLightOfBruteForce) {
    const Set& set = GetParam();
    if (set.looks == Looks::many) setMaterials(manyMaterials());
    if (set.looks == Looks::glazed) setMaterials(glazedMaterials(mesh_));
    const test::World world(mesh_, sky(), {.spacing = 0.25});
    const PlainLook plain;
    constexpr int kBounces = 3;
    std::optional<Solved> solved;
    if (set.solved)
        solved.emplace(world.scene, world.environment, world.cache.cache(), plain, kBounces,
                       world.light.get());
    EstimatorContext context = world.context();
    if (solved) {
        context.solve = &solved->solve;
        context.radiosity = &solved->radiosity;
    }
    const RenderOptions options = optionsOf(kBounces);
    const test::Estimates found = films(context, set.estimator, options, 40);
    const auto truth = truths(world.scene, world.environment, plain, kBounces, 200, 40);
    expectSameMean(found, truth, test::significance(1));
}

INSTANTIATE_TEST_SUITE_P(Sets, RoomBy,
                         testing::Values(Set{"plainByMis", Looks::plain, "mis", false},
                                         Set{"plainByCache", Looks::plain, "cache", true},
                                         Set{"materialsByMis", Looks::many, "mis", false},
                                         Set{"materialsByCache", Looks::many, "cache", true},
                                         Set{"glazedByMis", Looks::glazed, "mis", false},
                                         Set{"glazedByCache", Looks::glazed, "cache", true}),
                         [](const auto& set) { return set.param.name; });

// An uplight beneath the ceiling: most of what bounces comes from a spot that few rays by the
// cosine meet. Guided rays leave the mean as it is, and two thirds of the variance or less.
TEST_F(Room, IsGuidedToABrightSpot) {
    Material plain, lamp;
    plain.albedo = Rgb(0.6f);
    lamp.albedo = Rgb(0.4f);
    lamp.finish.emission = Rgb(400);
    lamp.doubleSided = false;
    const auto first = static_cast<std::uint32_t>(mesh_.triangles.size());
    test::addFloor(mesh_, 1.9f, -1.55f, -1.45f, -1.55f, -1.45f);
    setMaterials({{0, plain}, {first, lamp}});
    const test::World world(mesh_, sky(), {.spacing = 0.25});
    constexpr int kBounces = 1;
    // Their variances have a ratio of .59, which is known to .08.
    constexpr int kFilms = 240;
    const Solved solved(world.scene, world.environment, world.cache.cache(), {}, kBounces,
                        world.light.get());
    EstimatorContext context = world.context();
    context.solve = &solved.solve;
    const RenderOptions options = optionsOf(kBounces);
    const test::Estimates byCosine = films(context, "cache", options, kFilms);
    context.radiosity = &solved.radiosity;
    const test::Estimates guided = films(context, "cache", options, kFilms);
    expectSameMean(guided, byCosine.color, test::significance(1), 1.05);
    EXPECT_LT(guided.sampleVariance(1), 0.67 * byCosine.sampleVariance(1));
}

// Counts and hits of another set, and looks that are wrong, cost rays and change no mean.
TEST_F(Room, IsRightWhateverTheCacheHolds) {
    const Environment environment = test::environmentOf(sky());
    TriangleMesh other = mesh_;
    test::addBox(other, {-1.5f, 1, -1.5f}, {1.5f, 1.4f, 1});
    const test::World wrong(other, sky(), {.spacing = 0.25});
    const Scene scene(mesh_);
    constexpr int kBounces = 3;
    const ItemTable items(wrong.cache.cache());
    Transport transport = readTransport(wrong.cache.cache(), items).value();
    for (std::size_t i = 0; i < transport.hit.size(); ++i)
        transport.hit[i] = static_cast<std::uint32_t>(hashWords(i) % items.size());
    const std::vector<ItemLook> looks(items.size(), ItemLook{Rgb(0.9f), Rgb(0.1f)});
    const BounceSolve solve(wrong.cache.cache(), items, transport, environment, looks, kBounces);
    const EstimatorContext context{scene, environment, &wrong.cache.cache(), {}, &solve};
    expectSameMean(films(context, "cache", optionsOf(kBounces), 40),
                   truths(scene, environment, {}, kBounces, 200, 40), test::significance(1));
}

TEST_F(Room, SeesLightByWhatMoves) {
    TriangleMesh box;
    test::addBox(box, {0.3f, 0, 0.4f}, {0.9f, 0.9f, 1.2f});
    const test::World world(mesh_, sky(), {.spacing = 0.25});
    box.origin = world.mesh.origin;
    const Scene moving(box);
    Scene scene(world.mesh);
    scene.setMoving(&moving);
    constexpr int kBounces = 2;
    const Solved solved(world.scene, world.environment, world.cache.cache(), {}, kBounces);
    EstimatorContext context{scene, world.environment, &world.cache.cache(), {}, &solved.solve};
    context.radiosity = &solved.radiosity;
    expectSameMean(films(context, "cache", optionsOf(kBounces), 40),
                   truths(scene, world.environment, {}, kBounces, 200, 40), test::significance(1));
}

/// A larger picture of the room, of which every part is to have the same bits.
class RoomInParts : public Room {
protected:
    RoomInParts() : world_(mesh_, sky(), {.spacing = 0.25}) {
        solved_.emplace(world_.scene, world_.environment, world_.cache.cache(), PlainLook{}, 2);
    }
    ~RoomInParts() override { setThreadCount(0); }

    /// A frame with its plan, and the estimator that it refers to.
    struct Planned {
        std::unique_ptr<Estimator> estimator;
        FrameRequest frame;
    };

    Planned planned(const RenderOptions& options) const {
        EstimatorContext context{
            world_.scene, world_.environment, &world_.cache.cache(), {}, &solved_->solve};
        context.radiosity = &solved_->radiosity;
        auto estimator = findEstimator("cache").make(context, {});
        FrameRequest frame{*estimator, camera(), 1, options};
        RenderStats stats;
        frame.plan = planFrame(frame, stats);
        return {std::move(estimator), std::move(frame)};
    }

    Film film(const RenderOptions& options) const {
        const auto [estimator, frame] = planned(options);
        RenderStats stats;
        if (!passes_) return render(frame, stats);
        return renderProgressive(frame, stats, {}).film;
    }

    static RenderOptions options() {
        RenderOptions options = optionsOf(2);
        options.width = 70;
        options.height = 50;
        options.cameraRays = 4;
        options.samples = 2;
        options.passRays = 2;
        return options;
    }

    static void expectSamePart(const Film& whole, const Film& part) {
        for (int y = 0; y < part.height; ++y)
            for (int x = 0; x < part.width; ++x) {
                const Pixel& a = part.pixels[static_cast<std::size_t>(y * part.width + x)];
                const Pixel& b =
                    whole.pixels[static_cast<std::size_t>((y + part.y) * whole.width + x + part.x)];
                ASSERT_EQ(a.color, b.color) << x << ", " << y;
            }
    }

    test::World world_;
    std::optional<Solved> solved_;
    bool passes_ = false;
};

TEST_F(RoomInParts, HasTheSameBits) {
    setThreadCount(1);
    const Film whole = film(options());
    setThreadCount(3);
    expectSamePart(whole, film(options()));
    RenderOptions part = options();
    part.crop = FilmRectangle{33, 20, 9, 7};
    expectSamePart(whole, film(part));
    passes_ = true;
    expectSamePart(whole, film(options()));
    RenderOptions other = options();
    other.seed = 2;
    EXPECT_NE(film(other).pixels[0].color, whole.pixels[0].color);
}

TEST_F(RoomInParts, ReplaysItsPixels) {
    const Film whole = film(options());
    const auto [estimator, frame] = planned(options());
    int seen = 0;
    const Pixel pixel = renderPixel(frame, 41, 30, [&](const CameraSample&) { ++seen; });
    EXPECT_GE(seen, options().cameraRays);
    EXPECT_EQ(pixel.color, whole.pixels[30 * 70 + 41].color);
}

// All tiles are of one block: a first of them is taken after all have been lit.
TEST_F(RoomInParts, TellsHowFarItsBlockIs) {
    const auto [estimator, frame] = planned(options());
    RenderStats stats;
    const std::vector<std::size_t> tiles = Tiles(frame.options).touching(frame.options.region());
    std::atomic<std::size_t> told{0}, reports{0};
    std::size_t before = 0, taken = 0;
    const auto take = [&](const RenderedTile&) {
        if (++taken == 1) before = told;
    };
    renderTiles(frame, tiles, BlockExtent::wholeFrame, stats, {take, [&](std::size_t more) {
                                                                   told += more;
                                                                   ++reports;
                                                               }});
    EXPECT_EQ(taken, tiles.size());
    EXPECT_EQ(told, tiles.size());
    EXPECT_EQ(before, tiles.size());
    EXPECT_GT(reports, tiles.size() / 2);
}

TEST_F(RoomInParts, AddsUpFromItsParts) {
    const Film whole = film(options());
    for (const Pixel& p : whole.pixels) {
        const Rgb sum = p.diffuse + p.glossy + p.emission;
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(p.color[c], sum[c], 1e-5f * std::abs(p.color[c]) + 1e-6f);
            EXPECT_NE(p.diffuseIndirect[c], p.diffuse[c]);
        }
    }
    RenderOptions direct = options();
    direct.bounces = 0;
    const Film without = film(direct);
    double indirect = 0, all = 0;
    for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
        EXPECT_EQ(without.pixels[i].diffuseIndirect, Rgb(0, 0, 0));
        indirect += static_cast<double>(whole.pixels[i].diffuseIndirect.y);
        all += static_cast<double>(whole.pixels[i].color.y);
    }
    EXPECT_GT(indirect, 0.1 * all);
    EXPECT_LT(indirect, 0.9 * all);
}

TEST_F(RoomInParts, IsDarkerWhereBouncesAreClamped) {
    RenderOptions clamped = options();
    clamped.clampIndirect = 0.05f;
    const Film whole = film(options()), dark = film(clamped);
    double before = 0, after = 0;
    for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
        before += static_cast<double>(whole.pixels[i].diffuseIndirect.y);
        after += static_cast<double>(dark.pixels[i].diffuseIndirect.y);
        EXPECT_LT(dark.pixels[i].diffuseIndirect.y, 0.051f);
    }
    EXPECT_LT(after, before);
    EXPECT_GT(after, 0);
}

// With its control: the same without the light that bounces.
TEST_F(RoomInParts, IsPredictedWithoutRays) {
    RenderOptions exact = options();
    exact.cameraRays = 16;
    exact.samples = 16;
    exact.passRays = 16;
    RenderOptions predicted = options();
    predicted.samples = 0;
    RenderOptions direct = predicted;
    direct.bounces = 0;
    const auto mean = [](const Film& film) {
        double sum = 0;
        for (const Pixel& p : film.pixels) sum += static_cast<double>(p.color.y);
        return sum / static_cast<double>(film.pixels.size());
    };
    const double truth = mean(film(exact));
    EXPECT_NEAR(mean(film(predicted)) / truth, 1, 0.1);
    EXPECT_GT(std::abs(mean(film(direct)) / truth - 1), 0.2);
}

}  // namespace
}  // namespace shadowcache
