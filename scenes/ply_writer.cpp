#include "scenes/ply_writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "common/base/error.h"

namespace shadowcache::scenes {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is written as memory holds it");

constexpr std::size_t kBufferSize = std::size_t{1} << 20;

std::uint8_t toSrgb(float linear) {
    const float v = std::clamp(linear, 0.0f, 1.0f);
    const float s = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
    return static_cast<std::uint8_t>(std::lround(255.0f * s));
}

}  // namespace

PlyWriter::PlyWriter(const std::filesystem::path& path, std::uint64_t vertices,
                     std::uint64_t triangles)
    : path_(path), out_(path, std::ios::binary) {
    if (!out_) throwFileError(path_, "cannot be written");
    buffer_.reserve(kBufferSize);
    const std::string header = fmt::format(
        "ply\n"
        "format binary_little_endian 1.0\n"
        "comment +Y up, metres; vertex colours are sRGB albedo\n"
        "element vertex {}\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "element face {}\n"
        "property list uchar int vertex_indices\n"
        "end_header\n",
        vertices, triangles);
    put(header.data(), header.size());
}

void PlyWriter::vertex(const Vec3f& position, const Rgb& color) {
    char bytes[15];
    std::memcpy(bytes, &position.x, 12);
    bytes[12] = static_cast<char>(toSrgb(color.x));
    bytes[13] = static_cast<char>(toSrgb(color.y));
    bytes[14] = static_cast<char>(toSrgb(color.z));
    put(bytes, sizeof bytes);
}

void PlyWriter::triangle(const Vec3i& corners) {
    char bytes[13] = {3};
    std::memcpy(bytes + 1, &corners.x, 12);
    put(bytes, sizeof bytes);
}

void PlyWriter::put(const void* data, std::size_t size) {
    if (buffer_.size() + size > kBufferSize) {
        out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        buffer_.clear();
        if (!out_) throwFileError(path_, "cannot be written");
    }
    const char* bytes = static_cast<const char*>(data);
    buffer_.insert(buffer_.end(), bytes, bytes + size);
}

void PlyWriter::finish() {
    out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
    if (!out_.flush()) throwFileError(path_, "cannot be written");
}

}  // namespace shadowcache::scenes
