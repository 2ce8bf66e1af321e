#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace shadowcache::test {

/// A part of an OpenEXR file whose channels hold the same numbers: value + column + 100 row, of the
/// display window.
struct MapPart {
    Imf::Header header;
    std::vector<std::pair<std::string, float>> channels;
};

inline MapPart mapPart(const Imath::Box2i& display, const Imath::Box2i& data,
                       std::vector<std::pair<std::string, float>> channels,
                       const std::string& name = "map") {
    MapPart part{Imf::Header(display, data), std::move(channels)};
    part.header.setName(name);
    part.header.setType(Imf::SCANLINEIMAGE);
    for (const auto& [channel, value] : part.channels)
        part.header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    return part;
}

inline void writeMapParts(const std::filesystem::path& path, const std::vector<MapPart>& parts) {
    std::vector<Imf::Header> headers;
    for (const MapPart& part : parts) headers.push_back(part.header);
    Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const Imath::Box2i window = headers[p].dataWindow();
        const Imath::Box2i display = headers[p].displayWindow();
        std::vector<std::vector<float>> planes;
        for (const auto& [channel, value] : parts[p].channels) {
            std::vector<float> plane;
            for (int y = window.min.y; y <= window.max.y; ++y)
                for (int x = window.min.x; x <= window.max.x; ++x)
                    plane.push_back(value + static_cast<float>(x - display.min.x) +
                                    100.0f * static_cast<float>(y - display.min.y));
            planes.push_back(std::move(plane));
        }
        Imf::FrameBuffer frame;
        for (std::size_t c = 0; c < planes.size(); ++c)
            frame.insert(parts[p].channels[c].first,
                         Imf::Slice::Make(Imf::FLOAT, planes[c].data(), window));
        Imf::OutputPart output(file, static_cast<int>(p));
        output.setFrameBuffer(frame);
        output.writePixels(window.max.y - window.min.y + 1);
    }
}

}  // namespace shadowcache::test
