#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/shot/view.h"
#include "render/bounces/bounce_task.h"
#include "render/frame/frame_request.h"
#include "render/frame/pixel_filter.h"
#include "render/frame/pixel_sum.h"
#include "render/frame/tiles.h"

namespace shadowcache {

/// What the camera rays of a batch meet; reused from one to the next.
struct TileScratch {
    /// A camera ray, in the order of pixels and of rays in a pixel.
    struct Ray {
        std::uint32_t pixel = 0;  ///< number in the tile
        int number = 0;           ///< of the pixel's camera rays
        int row = 0;              ///< and of those in the batch
        CameraRay ray;
        View view;         ///< no hit: the sky
        Rgb sky{0, 0, 0};  ///< its radiance, if it is seen
    };
    /// What one of them meets on the set.
    struct Place {
        ShadingPoint point;
        Surface surface;
        Vec3f toViewer;  ///< of glossy surfaces
        Rgb diffuseAlbedo;
        std::optional<std::uint32_t> diffuse =
            {};                                    ///< number in `points`; none: nothing is diffuse
        std::optional<std::uint32_t> glossy = {};  ///< number in `glossyPoints`
    };
    /// Sobol' words of a pixel's camera rays: on the film, on the lens, and in time.
    std::array<std::vector<std::uint32_t>, 5> words;
    std::vector<std::uint64_t> seeds;  ///< of what lights a pixel
    std::vector<Ray> rays;
    std::vector<Place> places;         ///< of the rays that meet the set
    std::vector<ShadingPoint> points;  ///< those to estimate the irradiance of
    std::vector<Estimate> estimates;
    std::vector<GlossyPoint> glossyPoints;
    std::vector<GlossEstimate> glossEstimates;
    std::vector<WatchedSample> watched;  ///< of the pixel that the observer sees
    std::vector<BouncedLight> bounced;   ///< of `places`; empty: no light bounces
    std::uint64_t spreadRays = 0;        ///< camera rays that are none of the picture's
};

/// A batch of a tile's camera rays, whose light is known but for what bounces.
struct TileBatch {
    std::size_t firstPixel, pixels;  ///< of the tile
    TileScratch scratch;
};

/// Renders the pixels of one tile: sends their camera rays and has the places that these meet lit
/// together.
class TileRenderer {
public:
    explicit TileRenderer(const FrameRequest& request);

    /// What the camera sees at a place of the film.
    View look(const FilmPosition& at) const;

    /// The place that a camera ray met.
    SetPlace placeOf(const View& view) const;

    /// A place that a pilot looks at, through a place of the film; nothing where that shows the
    /// sky.
    ///
    /// @param floor  as AntialiasingRule has it; none: errors are relative to the place's own light
    std::optional<ShadingPoint> pilotPoint(const FilmPosition& at, std::uint64_t seed,
                                           std::optional<double> floor, TileScratch& scratch,
                                           Workspace& workspace) const;

    /// What `count` camera rays of each of some pixels are predicted to see; they are none of the
    /// picture's.
    ///
    /// @return of each pixel: nothing where the estimator predicts nothing
    std::vector<PredictedSpread> predictSpreads(std::span<const FilmPlace> places, int count,
                                                TileScratch& scratch, Workspace& workspace) const;

    /// Adds camera rays `first` to `first + count - 1` of each pixel of a tile, or as many times
    /// more as its factor: those of places[i] to sums[i].
    void addCameraRays(std::span<const FilmPlace> places, int first, int count,
                       TileScratch& scratch, Workspace& workspace, std::span<PixelSum> sums) const;

    /// What is to be known of camera rays.
    enum class Lighting {
        direct,  ///< the direct light of what they meet
        none     ///< only what they meet: others share what bounces there
    };
    /// Lights the same camera rays, but adds them to no pixel yet: they go to `batches`.
    void lightCameraRays(std::span<const FilmPlace> places, int first, int count, Lighting lighting,
                         TileScratch& scratch, Workspace& workspace, std::span<PixelSum> sums,
                         std::vector<TileBatch>& batches) const;
    /// Adds them to the tile's pixels.
    void addBatches(std::span<const TileBatch> batches, Workspace& workspace,
                    std::span<PixelSum> sums) const;
    /// The places of a batch that light bounces to.
    void findReceivers(const TileScratch& scratch, std::vector<BounceReceiver>& receivers) const;

    /// Camera rays 0 to `cameraRays - 1` of each pixel of a tile, pass by pass.
    void renderTile(std::span<const FilmPlace> places, int cameraRays, TileScratch& scratch,
                    Workspace& workspace, std::span<PixelSum> sums) const;

    /// The pixel so far.
    Pixel average(const PixelSum& sum) const;

    /// Has `observer` see each camera ray of the pixel (x, y) that meets the set.
    void observe(int x, int y, const CameraSampleObserver& observer);

private:
    /// Adds camera rays `first` to `first + count - 1` of a pixel to scratch.rays.
    void aim(const FilmPlace& place, std::uint32_t pixel, std::uint64_t seed, int first, int count,
             TileScratch& scratch) const;
    void intersect(std::span<TileScratch::Ray> rays) const;
    /// Cuts camera rays of pixels into batches of bounded memory: `visit` gets the first pixel and
    /// the number of pixels, the first camera ray and the number of camera rays of each.
    template <class Visit>
    void forEachBatch(std::size_t pixels, int first, int count, const Visit& visit) const;
    /// Sends the camera rays of a batch, and sorts what they meet.
    void meetBatch(std::span<const FilmPlace> places, int first, int count, TileScratch& scratch,
                   std::span<PixelSum> sums) const;
    /// Does so, and estimates the light of what they meet.
    void lightBatch(std::span<const FilmPlace> places, int first, int count, TileScratch& scratch,
                    Workspace& workspace, std::span<PixelSum> sums) const;
    void addBatch(const TileScratch& scratch, Workspace& workspace, std::span<PixelSum> sums) const;
    /// Radiance that a camera ray is predicted to see.
    Rgb predictRadiance(const View& view, const FilmPlace& place, Workspace& workspace) const;
    /// Camera rays of each pixel, and what its errors are relative to.
    void planPixels(std::span<const FilmPlace> places, TileScratch& scratch, Workspace& workspace,
                    std::span<PixelSum> sums) const;
    void sendCameraRays(std::span<const FilmPlace> places, int first, int count,
                        TileScratch& scratch, std::span<PixelSum> sums) const;
    /// What a pixel shows of the sky.
    Rgb skyAlong(const Vec3f& direction) const;
    /// Irradiance by which a surface of such an albedo has a radiance.
    float irradianceScale(double radiance, const Rgb& albedo) const;
    PointBatch batchOf(std::span<const ShadingPoint> points, std::size_t pixels, int count) const;
    /// Sorts the places by what light is to be estimated of them.
    void findPoints(TileScratch& scratch) const;
    void addToPixel(const TileScratch& scratch, std::size_t number, const TileScratch::Ray& ray,
                    Workspace& workspace, PixelSum& pixel) const;

    const Estimator& estimator_;
    const EstimatorContext& context_;
    const CameraRays camera_;
    const int number_;
    const RenderOptions& options_;
    const PixelFilter filter_;
    const int runLength_;
    const FramePlan& plan_;
    const CameraSampleObserver* observer_ = nullptr;
    FilmPlace observed_{-1, -1};  ///< pixel that the observer sees
};

}  // namespace shadowcache
