// The smallest path tracer that lights with a cache: at every vertex of a path, direct light by one
// sample of the cache and its control variate. Grey diffuse surfaces, a map, bounced light.
//   path_tracer set.obj set.vdb sky.exr picture.pfm [NAME=VALUE...]
// eye=X,Y,Z target=X,Y,Z fov=DEGREES size=WIDTH,HEIGHT spp=N bounces=N albedo=A seed=N
#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/cache/shadow_cache.h"
#include "common/image/radiance.h"
#include "common/math/vec.h"
#include "render/samples/light_sampler.h"

using namespace shadowcache;

namespace {

struct Options {
    std::vector<double> eye{3, 2, 4}, target{0, 0, 0}, size{64, 64};
    double fov = 45, spp = 16, bounces = 4, albedo = 0.5, seed = 1;
};

/// Where rays start, off the surface [m].
constexpr float kOffset = 1e-4f;

std::vector<double> numbersIn(std::string text) {
    std::ranges::replace(text, ',', ' ');
    std::istringstream words(text);
    std::vector<double> numbers;
    for (double number = 0; words >> number;) numbers.push_back(number);
    if (numbers.empty() || !words.eof()) throw std::runtime_error(text + ": expected numbers");
    return numbers;
}

void setOption(Options& o, const std::string& text) {
    const std::size_t equals = std::min(text.find('='), text.size() - 1);
    const std::string name = text.substr(0, equals);
    const std::vector<double> value = numbersIn(text.substr(equals + 1));
    if (name == "eye" && value.size() == 3)
        o.eye = value;
    else if (name == "target" && value.size() == 3)
        o.target = value;
    else if (name == "size" && value.size() == 2)
        o.size = value;
    else if (name == "fov")
        o.fov = value[0];
    else if (name == "spp")
        o.spp = value[0];
    else if (name == "bounces")
        o.bounces = value[0];
    else if (name == "albedo")
        o.albedo = value[0];
    else if (name == "seed")
        o.seed = value[0];
    else
        throw std::runtime_error(text + ": unknown option");
}

/// Numbers in [0, 1). [Steele, Lea & Flood 2014, splitmix64]
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) { next(); }
    double next() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
    float nextFloat() { return std::min(static_cast<float>(next()), 0x1.fffffep-1f); }

private:
    std::uint64_t state_;
};

/// A set in Embree: the polygons of an OBJ file, as fans.
class Set {
public:
    explicit Set(const char* path) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
        std::ifstream file(path);
        if (!file) throw std::runtime_error(std::string(path) + ": cannot be read");
        std::vector<Vec3f> vertices;
        std::vector<unsigned> corners;
        for (std::string line, word; std::getline(file, line);) {
            std::istringstream words(line);
            Vec3f v(0.0f);
            if (!(words >> word)) continue;
            if (word == "v" && words >> v.x >> v.y >> v.z) vertices.push_back(v);
            std::vector<unsigned> face;
            while (word == "f" && words >> word) {
                face.push_back(static_cast<unsigned>(std::stoul(word)) - 1);
                word = "f";
            }
            for (std::size_t i = 2; i < face.size(); ++i)
                corners.insert(corners.end(), {face[0], face[i - 1], face[i]});
        }
        const RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        std::ranges::copy(vertices, static_cast<Vec3f*>(rtcSetNewGeometryBuffer(
                                        mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                        sizeof(Vec3f), vertices.size())));
        std::ranges::copy(corners, static_cast<unsigned*>(rtcSetNewGeometryBuffer(
                                       mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                       3 * sizeof(unsigned), corners.size() / 3)));
        rtcCommitGeometry(mesh);
        rtcAttachGeometry(scene_, mesh);
        rtcReleaseGeometry(mesh);
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcCommitScene(scene_);
    }
    ~Set() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Set(const Set&) = delete;
    Set& operator=(const Set&) = delete;

    /// Goes along a ray to what it meets; false: the sky. The normal is towards the ray's start.
    bool meet(Vec3f& at, const Vec3f& direction, Vec3f& normal) const {
        RTCRayHit hit{};
        hit.ray = {.org_x = at.x,
                   .org_y = at.y,
                   .org_z = at.z,
                   .tnear = 0,
                   .dir_x = direction.x,
                   .dir_y = direction.y,
                   .dir_z = direction.z,
                   .time = 0,
                   .tfar = std::numeric_limits<float>::infinity(),
                   .mask = ~0u,
                   .id = 0,
                   .flags = 0};
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene_, &context, &hit);
        if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
        at += direction * hit.ray.tfar;
        normal = Vec3f(hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z).normalized();
        if (normal.dot(direction) > 0) normal = -normal;
        return true;
    }
    bool seesTheSky(Vec3f from, const Vec3f& direction) const {
        Vec3f normal;
        return !meet(from, direction, normal);
    }

private:
    RTCDevice device_;
    RTCScene scene_;
};

/// Irradiance at a place, of one ray: the light that comes straight from the sky.
Rgb directLight(const Set& set, const Vec3f& at, const Vec3f& start, const Vec3f& normal,
                LightSampler::Reader& light, Random& random) {
    light.moveTo(Vec3d(at), normal);
    if (light.empty()) return light.integral();
    const double u = random.next();
    const float x = random.nextFloat();
    const LightSample s = light.sample(u, x, random.nextFloat());
    const float cosine = s.direction.dot(normal);
    const bool seen = cosine > 0 && set.seesTheSky(start, s.direction);
    const Rgb found = seen ? s.radiance * cosine : Rgb(0.0f);
    return light.integral() + (found - s.control) / static_cast<float>(s.pdf);
}

/// Direction of a density in proportion to the cosine.
Vec3f aroundNormal(const Vec3f& normal, Random& random) {
    Vec3f s, t;
    tangentFrame(normal, s, t);
    const float angle = 2 * static_cast<float>(kPi) * random.nextFloat();
    const float sine2 = random.nextFloat(), sine = std::sqrt(sine2);
    return (s * (sine * std::cos(angle)) + t * (sine * std::sin(angle)) +
            normal * std::sqrt(1 - sine2))
        .normalized();
}

/// Radiance that a path brings back.
Rgb radianceAlong(const Set& set, Vec3f at, Vec3f direction, const Options& o,
                  LightSampler::Reader& light, Random& random) {
    Rgb sum(0.0f);
    float weight = 1;
    for (int vertex = 0; vertex <= static_cast<int>(o.bounces); ++vertex) {
        Vec3f normal;
        if (!set.meet(at, direction, normal))  // later rays to the sky are those of directLight()
            return vertex == 0 ? light.along(direction).radiance : sum;
        const Vec3f start = at + normal * kOffset;
        weight *= static_cast<float>(o.albedo);
        sum +=
            directLight(set, at, start, normal, light, random) * (weight / static_cast<float>(kPi));
        at = start;
        direction = aroundNormal(normal, random);
    }
    return sum;
}

std::vector<Rgb> render(const Set& set, const LightSampler& sampler, const Options& o) {
    const int width = static_cast<int>(o.size[0]), height = static_cast<int>(o.size[1]);
    const int spp = static_cast<int>(o.spp);
    const Vec3f eye(Vec3d(o.eye[0], o.eye[1], o.eye[2]));
    const Vec3f target(Vec3d(o.target[0], o.target[1], o.target[2]));
    const Vec3f forward = (target - eye).normalized();
    const Vec3f right = forward.cross(Vec3f(0, 1, 0)).normalized(), up = right.cross(forward);
    const auto tangent = static_cast<float>(std::tan(o.fov * kPi / 360));
    const auto rowPixels = static_cast<std::size_t>(width);
    std::vector<Rgb> picture(rowPixels * static_cast<std::size_t>(height), Rgb(0.0f));
    std::atomic<int> nextRow{0};
    const auto work = [&] {
        LightSampler::Reader light(sampler);
        for (int y = nextRow++; y < height; y = nextRow++)
            for (int x = 0; x < width; ++x) {
                const auto pixel =
                    static_cast<std::size_t>(y) * rowPixels + static_cast<std::size_t>(x);
                Random random(static_cast<std::uint64_t>(o.seed) << 40 ^ pixel << 8);
                for (int i = 0; i < spp; ++i) {
                    const float u = 2 * (static_cast<float>(x) + random.nextFloat()) /
                                        static_cast<float>(width) -
                                    1;
                    const float v = 1 - 2 * (static_cast<float>(y) + random.nextFloat()) /
                                            static_cast<float>(height);
                    const Vec3f way = forward + up * (v * tangent) +
                                      right * (u * tangent * static_cast<float>(width) /
                                               static_cast<float>(height));
                    picture[pixel] += radianceAlong(set, eye, way.normalized(), o, light, random) /
                                      static_cast<float>(spp);
                }
            }
    };
    std::vector<std::jthread> threads(std::max(1u, std::thread::hardware_concurrency()));
    for (std::jthread& thread : threads) thread = std::jthread(work);
    threads.clear();  // waits
    return picture;
}

/// A portable float map: rows from below.
void writePfm(const char* path, int width, int height, const std::vector<Rgb>& picture) {
    std::ofstream file(path, std::ios::binary);
    file << "PF\n" << width << ' ' << height << "\n-1\n";
    const auto rowPixels = static_cast<std::size_t>(width);
    for (std::size_t end = picture.size(); end > 0; end -= rowPixels)
        file.write(reinterpret_cast<const char*>(&picture[end - rowPixels]),
                   static_cast<std::streamsize>(sizeof(Rgb) * rowPixels));
    if (!file.flush()) throw std::runtime_error(std::string(path) + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc < 5) {
        std::fprintf(stderr,
                     "usage: path_tracer set.obj set.vdb sky.exr picture.pfm [NAME=VALUE...]\n");
        return 2;
    }
    Options options;
    for (int i = 5; i < argc; ++i) setOption(options, argv[i]);
    const Set set(argv[1]);
    const ShadowCache cache(argv[2]);
    const LightSampler sampler(cache, readRadiance(argv[3]));
    writePfm(argv[4], static_cast<int>(options.size[0]), static_cast<int>(options.size[1]),
             render(set, sampler, options));
} catch (const std::exception& e) {
    std::fprintf(stderr, "path_tracer: %s\n", e.what());
    return 1;
}
