#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace shadowcache::test {

/// The bytes of a plain value as a file holds them.
template <class T>
std::string bytesOf(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

inline constexpr std::array<float, 12> kSquareCorners{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

/// The unit square [0, 1] x [0, 1] at z = 0 as two triangles, one file for each format.
inline std::string squareObj() {
    return "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
}
inline std::string squareOff() {
    return "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
}
inline std::string squarePlyText() {
    return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
           "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
}
inline std::string squarePly() {
    std::string bytes =
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\n"
        "property float y\nproperty float z\nelement face 2\n"
        "property list uchar int vertex_indices\nend_header\n";
    bytes += bytesOf(kSquareCorners);
    for (const auto& face : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
        bytes += '\3';
        for (const int corner : face) bytes += bytesOf(corner);
    }
    return bytes;
}
/// Binary STL of triangles given as nine coordinates each.
inline std::string stl(const std::vector<std::array<float, 9>>& triangles) {
    std::string bytes(80, ' ');
    bytes += bytesOf(static_cast<std::uint32_t>(triangles.size()));
    for (const auto& triangle : triangles) {
        bytes += std::string(12, '\0') + bytesOf(triangle) + std::string(2, '\0');
    }
    return bytes;
}
inline std::string squareStl() {
    return stl({{0, 0, 0, 1, 0, 0, 1, 1, 0}, {0, 0, 0, 1, 1, 0, 0, 1, 0}});
}
inline std::string squareStlText() {
    return "solid my vertex\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
           "vertex 1 1 0\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
           "vertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
}
/// OpenMesh's own format, version 1: positions and the corners of triangles.
inline std::string squareOm() {
    std::string bytes = "OMT";
    bytes += '\x22';  // version 1.2
    for (const std::uint32_t count : {4u, 2u, 5u}) bytes += bytesOf(count);
    bytes += bytesOf(std::uint16_t{0x1600});  // vertex positions, 3 floats of 32 bits
    bytes += bytesOf(kSquareCorners);
    bytes += bytesOf(std::uint16_t{0x00e8});  // face topology, 8-bit numbers
    bytes += std::string("\0\1\2\0\2\3", 6);
    return bytes;
}
/// A file that OpenMesh 9 wrote (version 2, half-edges, colours): a square and a triangle beside
/// it.
inline std::string squareAndTriangleOm2() {
    static constexpr unsigned char kBytes[] = {
        0x4f, 0x4d, 0x50, 0x42, 0x05, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x06, 0x00, 0x00,
        0x00, 0x00, 0x16, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80,
        0x3f, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x80, 0x3f, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x40, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x80, 0x10, 0xff, 0x00, 0x80, 0xff, 0x00, 0x80, 0xff, 0x00, 0x80, 0xff,
        0x00, 0x80, 0xff, 0x00, 0x80, 0xf8, 0x16, 0x02, 0x01, 0x00, 0x07, 0x00, 0xff, 0x04, 0x02,
        0x00, 0x08, 0x01, 0x01, 0x06, 0x03, 0x00, 0x0b, 0x02, 0xff, 0x00, 0x00, 0x00, 0x05, 0x03,
        0xff, 0x0a, 0x04, 0x01, 0x01, 0x01, 0xff, 0x03, 0x02, 0x01, 0x09, 0x04, 0xff, 0xe0, 0x06,
        0x07, 0x01, 0x0b, 0x05, 0x09, 0xe8, 0x06, 0x06, 0x03, 0x1c, 0x00};
    return {reinterpret_cast<const char*>(kBytes), sizeof kBytes};
}

}  // namespace shadowcache::test
