#include <algorithm>
#include <cmath>
#include <fstream>

#include "common/base/error.h"
#include "scenes/geometry.h"
#include "scenes/ply_writer.h"

namespace shadowcache::scenes {
namespace {

/// Point of the keys' curve at t in [0, 1]. [Catmull & Rom 1974]
Vec3d curvePoint(std::span<const CameraKey> keys, double t, Vec3d CameraKey::*part) {
    const int last = static_cast<int>(keys.size()) - 1;
    const int i = std::clamp(static_cast<int>(t * last), 0, last - 1);
    const double f = t * last - i;
    const auto key = [&](int k) {
        return keys[static_cast<std::size_t>(std::clamp(k, 0, last))].*part;
    };
    const Vec3d a = key(i - 1);
    const Vec3d b = key(i);
    const Vec3d c = key(i + 1);
    const Vec3d d = key(i + 2);
    return (b * 2.0 + (c - a) * f + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (f * f) +
            (b * 3.0 - a - c * 3.0 + d) * (f * f * f)) *
           0.5;
}

void writeVector(std::ostream& out, const char* name, const Vec3d& v) {
    out << '"' << name << "\": [" << v.x << ", " << v.y << ", " << v.z << ']';
}

}  // namespace

void writeCamera(const std::filesystem::path& path, std::span<const CameraKey> keys, int frames,
                 double fps, double fovYRadians) {
    std::ofstream out(path);
    out.precision(7);
    out << "{\"cam\": {\"yfov\": " << fovYRadians << ", \"fps\": " << fps << ", \"frames\": [";
    for (int frame = 0; frame < frames; ++frame) {
        const double t = static_cast<double>(frame) / (frames - 1);
        const Vec3d origin = curvePoint(keys, t, &CameraKey::position);
        const Vec3d forward = (curvePoint(keys, t, &CameraKey::target) - origin).normalized();
        const Vec3d right = forward.cross(Vec3d(0, 1, 0)).normalized();
        out << (frame ? ",\n" : "\n") << "{\"t\": " << frame / fps << ", ";
        writeVector(out, "origin", origin);
        writeVector(out << ", ", "forward", forward);
        writeVector(out << ", ", "up", right.cross(forward));
        out << '}';
    }
    out << "\n]}}\n";
    if (!out.flush()) throwFileError(path, "cannot be written");
}

SetPart partOf(const SetMesh& mesh, const std::function<bool(Finish)>& isIn) {
    SetPart part;
    std::vector<int> number(mesh.positions.size(), -1);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (!isIn(mesh.finishes[i])) continue;
        Vec3i corners = mesh.triangles[i];
        for (int k = 0; k < 3; ++k) {
            const auto v = static_cast<std::size_t>(corners[k]);
            if (number[v] < 0) {
                number[v] = static_cast<int>(part.vertices.size());
                part.vertices.push_back(v);
            }
            corners[k] = number[v];
        }
        part.triangles.push_back(corners);
    }
    return part;
}

void writePly(const std::filesystem::path& path, const SetMesh& mesh) {
    const SetPart part = partOf(mesh, [](Finish) { return true; });
    PlyWriter writer(path, part.vertices.size(), part.triangles.size());
    for (const std::size_t v : part.vertices) writer.vertex(mesh.positions[v], mesh.colors[v]);
    for (const Vec3i& t : part.triangles) writer.triangle(t);
    writer.finish();
}

}  // namespace shadowcache::scenes
