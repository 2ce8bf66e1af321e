#include "common/mesh/mesh_statistics.h"

#include <algorithm>
#include <array>

#include "common/base/parallel.h"
#include "common/mesh/placed_mesh.h"
#include "common/mesh/point_table.h"

namespace shadowcache {

namespace {

constexpr std::size_t kVerticesPerChunk = 1 << 14;

/// Items sorted into groups by vertex: those of v are items[starts[v]] to items[starts[v + 1] - 1].
template <class T>
struct Groups {
    std::vector<std::size_t> starts;
    std::vector<T> items;
};

using Corners = std::array<std::uint32_t, 3>;

/// Counting sort of what `emit(corners, sink)` passes to sink(vertex, item) for every triangle.
template <class T, class Emit>
Groups<T> groupByVertex(const std::vector<Corners>& triangles, std::size_t vertices,
                        const Emit& emit) {
    Groups<T> groups;
    groups.starts.assign(vertices + 2, 0);
    for (const Corners& c : triangles) {
        emit(c, [&](std::uint32_t vertex, T) { ++groups.starts[vertex + 2]; });
    }
    for (std::size_t v = 2; v < groups.starts.size(); ++v) groups.starts[v] += groups.starts[v - 1];
    groups.items.resize(groups.starts.back());
    // starts[v + 1] runs from the group's start to its end here, which leaves the starts in place.
    for (const Corners& c : triangles) {
        emit(c, [&](std::uint32_t vertex, T item) {
            groups.items[groups.starts[vertex + 1]++] = item;
        });
    }
    return groups;
}

/// Sum over all groups, each sorted first.
template <class T, class Count>
double sumOverGroups(Groups<T>& groups, const Count& count) {
    return parallelSum(groups.starts.size() - 2, kVerticesPerChunk, [&](const Chunk& chunk) {
        double sum = 0.0;
        for (std::size_t v = chunk.begin; v < chunk.end; ++v) {
            const auto begin = groups.items.begin() + static_cast<std::ptrdiff_t>(groups.starts[v]);
            const auto end =
                groups.items.begin() + static_cast<std::ptrdiff_t>(groups.starts[v + 1]);
            std::sort(begin, end);
            sum += static_cast<double>(count(begin, end));
        }
        return sum;
    });
}

std::vector<Corners> weldedTriangles(const TriangleMesh& mesh, std::size_t& vertices) {
    PointTable table(mesh.positions.size());
    std::vector<std::uint32_t> number;
    number.reserve(mesh.positions.size());
    for (const Vec3f& p : mesh.positions) number.push_back(table.add(p));
    vertices = table.points().size();

    std::vector<Corners> triangles;
    const std::size_t direct = directCount(mesh);
    triangles.reserve(direct);
    for (std::size_t i = 0; i < direct; ++i) {
        const Vec3i& t = mesh.triangles[i];
        triangles.push_back({number[static_cast<std::size_t>(t.x)],
                             number[static_cast<std::size_t>(t.y)],
                             number[static_cast<std::size_t>(t.z)]});
    }
    return triangles;
}

std::size_t countDuplicates(const std::vector<Corners>& triangles, std::size_t vertices) {
    const auto emit = [](Corners c, const auto& sink) {
        std::sort(c.begin(), c.end());
        sink(c[0], (std::uint64_t{c[1]} << 32) | c[2]);
    };
    auto groups = groupByVertex<std::uint64_t>(triangles, vertices, emit);
    return static_cast<std::size_t>(sumOverGroups(groups, [](auto begin, auto end) {
        std::ptrdiff_t distinct = std::unique(begin, end) - begin;
        return (end - begin) - distinct;
    }));
}

/// Length of the run of one edge at `begin`, whatever its direction.
template <class Iterator>
std::ptrdiff_t edgeRun(Iterator begin, Iterator end) {
    const auto other = [](std::uint32_t item) { return item >> 1; };
    return std::find_if(begin, end,
                        [&](std::uint32_t item) { return other(item) != other(*begin); }) -
           begin;
}

}  // namespace

void countDefects(TriangleMesh& mesh) {
    std::size_t vertices = 0;
    const std::vector<Corners> triangles = weldedTriangles(mesh, vertices);
    mesh.report.duplicates = countDuplicates(triangles, vertices);

    // An edge is kept with its lower vertex, as the upper one and whether it runs upwards.
    const auto emit = [](const Corners& c, const auto& sink) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t from = c[i];
            const std::uint32_t to = c[(i + 1) % 3];
            sink(std::min(from, to), (std::max(from, to) << 1) | (from < to ? 1u : 0u));
        }
    };
    auto groups = groupByVertex<std::uint32_t>(triangles, vertices, emit);
    mesh.report.nonManifoldEdges =
        static_cast<std::size_t>(sumOverGroups(groups, [](auto begin, auto end) {
            std::size_t count = 0;
            for (std::ptrdiff_t run = 0; begin != end; begin += run) {
                run = edgeRun(begin, end);
                if (run > 2) ++count;
            }
            return count;
        }));
    mesh.report.mixedWinding =
        static_cast<std::size_t>(sumOverGroups(groups, [](auto begin, auto end) {
            std::size_t count = 0;
            for (std::ptrdiff_t run = 0; begin != end; begin += run) {
                run = edgeRun(begin, end);
                if (run == 2 && begin[0] == begin[1]) ++count;
            }
            return count;
        }));
}

}  // namespace shadowcache
