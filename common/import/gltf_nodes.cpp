#include "common/import/gltf_nodes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.h"
#include "common/import/gltf_budget.h"

namespace shadowcache {

namespace {

using Quaternion = std::array<double, 4>;
using Interpolation = GltfChannel::Interpolation;
using Path = GltfChannel::Path;

double dot(const Quaternion& a, const Quaternion& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

Quaternion unit(const Quaternion& q) {
    const double length = std::sqrt(dot(q, q));
    if (!(length > 0)) return {0, 0, 0, 1};
    return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

/// Spherical linear interpolation along the shorter arc.
Quaternion slerp(const Quaternion& a, Quaternion b, double t) {
    double cosine = dot(a, b);
    if (cosine < 0) {
        for (double& x : b) x = -x;
        cosine = -cosine;
    }
    double wa = 1 - t, wb = t;
    // Nearer than this the straight line is as good, and its divisor no problem.
    if (cosine < 0.9999) {
        const double angle = std::acos(cosine);
        wa = std::sin((1 - t) * angle) / std::sin(angle);
        wb = std::sin(t * angle) / std::sin(angle);
    }
    Quaternion result;
    for (std::size_t k = 0; k < 4; ++k) result[k] = wa * a[k] + wb * b[k];
    return unit(result);
}

Quaternion quaternion(const std::vector<double>& value) {
    return {value[0], value[1], value[2], value[3]};
}

GltfTrack decodeTrack(const GltfDocument& document, const std::string& animation,
                      const GltfChannel& channel, std::size_t size) {
    const auto fail = [&](const std::string& cause) {
        throwFileError(document.path, "animation " + animation + ": " + cause);
    };
    GltfTrack track{channel, {}, size, {}};
    std::string cause;
    track.times = decode(document.accessor(channel.times), cause);
    track.values = decode(document.accessor(channel.values), cause);
    if (!cause.empty()) fail(cause);
    const std::size_t numbers =
        size * (channel.interpolation == Interpolation::cubicSpline ? 3 : 1);
    // Weights are single numbers, as many as there are targets.
    const std::size_t components = channel.path == Path::weights ? 1 : size;
    if (document.accessor(channel.times).array.components != 1 ||
        document.accessor(channel.values).array.components != components ||
        track.values.size() != track.times.size() * numbers)
        fail(fmt::format("{} numbers for {} keys, expected {} for each", track.values.size(),
                         track.times.size(), numbers));
    if (track.times.empty()) fail("no keys, expected at least one");
    const auto finite = [](double x) { return std::isfinite(x); };
    if (!std::all_of(track.values.begin(), track.values.end(), finite) ||
        !std::all_of(track.times.begin(), track.times.end(), finite))
        fail("a key is not a finite number");
    if (!std::is_sorted(track.times.begin(), track.times.end()))
        fail("key times are not in ascending order");
    return track;
}

}  // namespace

Affine fromParts(const Vec3d& translation, const std::array<double, 4>& rotation,
                 const Vec3d& scale) {
    const auto [x, y, z, w] = unit(rotation);
    const Vec3d right(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w));
    const Vec3d up(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w));
    const Vec3d back(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y));
    return {{right * scale.x, up * scale.y, back * scale.z}, translation};
}

std::vector<double> GltfTrack::at(double time) const {
    // Keys have their times as floats: at one that stands for this time, its value holds.
    const auto seconds = static_cast<double>(static_cast<float>(time));
    const bool cubic = channel.interpolation == Interpolation::cubicSpline;
    // `part` of a cubic key: 0 in-tangent, 1 value, 2 out-tangent.
    const auto key = [&](std::size_t i, std::size_t part) {
        const auto first =
            values.begin() + static_cast<std::ptrdiff_t>(cubic ? (3 * i + part) * size : i * size);
        return std::vector<double>(first, first + static_cast<std::ptrdiff_t>(size));
    };
    const auto next = std::upper_bound(times.begin(), times.end(), seconds);
    if (next == times.begin()) return key(0, 1);
    const auto i = static_cast<std::size_t>(next - times.begin()) - 1;
    if (next == times.end() || channel.interpolation == Interpolation::step) return key(i, 1);

    const double span = times[i + 1] - times[i];
    const double t = (seconds - times[i]) / span;
    const std::vector<double> a = key(i, 1), b = key(i + 1, 1);
    if (!cubic && channel.path == Path::rotation) {
        const Quaternion q = slerp(unit(quaternion(a)), unit(quaternion(b)), t);
        return {q.begin(), q.end()};
    }
    std::vector<double> value(size);
    if (!cubic) {
        for (std::size_t k = 0; k < size; ++k) value[k] = a[k] + (b[k] - a[k]) * t;
        return value;
    }
    const std::vector<double> out = key(i, 2), in = key(i + 1, 0);
    const double t2 = t * t, t3 = t2 * t;
    for (std::size_t k = 0; k < size; ++k)
        value[k] = (2 * t3 - 3 * t2 + 1) * a[k] + span * (t3 - 2 * t2 + t) * out[k] +
                   (3 * t2 - 2 * t3) * b[k] + span * (t3 - t2) * in[k];
    return value;
}

bool GltfTrack::varies() const {
    if (size == 0) return false;
    const bool cubic = channel.interpolation == Interpolation::cubicSpline;
    const std::size_t stride = cubic ? 3 * size : size;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t within = i % stride;
        const bool tangent = cubic && within / size != 1;
        // The tangents outside of the first and the last key reach no time.
        const bool outside = cubic && (i < size || i + size >= values.size());
        if (!outside && values[i] != (tangent ? 0.0 : values[within])) return true;
    }
    return false;
}

GltfNodes::GltfNodes(const GltfDocument& document)
    : document_(document), tracks_(document.nodes.size()) {
    GltfBudget budget(document);
    for (const GltfAnimation& animation : document.animations)
        for (const GltfChannel& channel : animation.channels) {
            const GltfNode& node = document.nodes[static_cast<std::size_t>(channel.node)];
            std::size_t size = channel.path == Path::rotation ? 4 : 3;
            if (channel.path == Path::weights)
                size = node.mesh < 0
                           ? 0
                           : document.meshes[static_cast<std::size_t>(node.mesh)].targetCount();
            if (size == 0) continue;
            for (const int index : {channel.times, channel.values})
                budget.take(document.accessor(index).count *
                            document.accessor(index).array.components);
            tracks_[static_cast<std::size_t>(channel.node)].push_back(
                decodeTrack(document, animation.name, channel, size));
        }
    for (const auto& tracks : tracks_)
        isMoved_.push_back(std::ranges::any_of(tracks, [](const GltfTrack& track) {
            return track.channel.path != Path::weights && track.varies();
        }));
    for (const GltfSkin& skin : document.skins)
        skinMoves_.push_back(std::ranges::any_of(skin.joints, [&](int n) { return moves(n); }));
}

Affine GltfNodes::local(int node, double seconds) const {
    const GltfNode& n = document_.nodes[static_cast<std::size_t>(node)];
    const auto& tracks = tracks_[static_cast<std::size_t>(node)];
    const bool moved = std::ranges::any_of(
        tracks, [](const GltfTrack& track) { return track.channel.path != Path::weights; });
    if (n.matrix && !moved) return *n.matrix;
    Vec3d translation = n.translation, scale = n.scale;
    Quaternion rotation = n.rotation;
    for (const GltfTrack& track : tracks) {
        if (track.channel.path == Path::weights) continue;
        const std::vector<double> value = track.at(seconds);
        const Vec3d vector(value[0], value[1], value[2]);
        if (track.channel.path == Path::translation) translation = vector;
        if (track.channel.path == Path::scale) scale = vector;
        if (track.channel.path == Path::rotation) rotation = quaternion(value);
    }
    return fromParts(translation, rotation, scale);
}

Affine GltfNodes::at(int node, double seconds) const {
    Affine result = local(node, seconds);
    for (int n = document_.nodes[static_cast<std::size_t>(node)].parent; n >= 0;
         n = document_.nodes[static_cast<std::size_t>(n)].parent)
        result = compose(local(n, seconds), result);
    if (!result.isFinite())
        throwFileError(document_.path, "node " +
                                           document_.nodes[static_cast<std::size_t>(node)].name +
                                           ": its transform to the world is not finite");
    return result;
}

bool GltfNodes::moves(int node) const {
    for (int n = node; n >= 0; n = document_.nodes[static_cast<std::size_t>(n)].parent)
        if (isMoved_[static_cast<std::size_t>(n)]) return true;
    return false;
}

std::vector<double> GltfNodes::weights(int node, double seconds) const {
    const GltfNode& n = document_.nodes[static_cast<std::size_t>(node)];
    const auto& tracks = tracks_[static_cast<std::size_t>(node)];
    // Of several the last counts, as with places.
    const auto track = std::find_if(tracks.rbegin(), tracks.rend(), [](const GltfTrack& t) {
        return t.channel.path == Path::weights;
    });
    if (track != tracks.rend()) return track->at(seconds);
    if (!n.weights.empty() || n.mesh < 0) return n.weights;
    return document_.meshes[static_cast<std::size_t>(n.mesh)].weights;
}

bool GltfNodes::deforms(int node) const {
    const GltfNode& n = document_.nodes[static_cast<std::size_t>(node)];
    for (const GltfTrack& track : tracks_[static_cast<std::size_t>(node)])
        if (track.channel.path == Path::weights && track.varies()) return true;
    return n.skin >= 0 && skinMoves_[static_cast<std::size_t>(n.skin)];
}

std::vector<int> GltfNodes::meshNodes(bool moving) const {
    std::vector<int> found;
    for (int i = 0; i < static_cast<int>(document_.nodes.size()); ++i) {
        const GltfNode& node = document_.nodes[static_cast<std::size_t>(i)];
        if (!node.inScene || node.mesh < 0) continue;
        // The joints of a skin take its mesh along, wherever its node is.
        const bool isMoving = deforms(i) || (node.skin < 0 && moves(i));
        if (isMoving == moving) found.push_back(i);
    }
    return found;
}

double GltfNodes::duration() const {
    double last = 0;
    for (const auto& tracks : tracks_)
        for (const GltfTrack& track : tracks) last = std::max(last, track.times.back());
    return last;
}

}  // namespace shadowcache
