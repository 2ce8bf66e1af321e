#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfFramesPerSecond.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/base/atomic_file.h"
#include "common/base/error.h"
#include "common/image/exr.h"
#include "common/image/exr_error.h"

namespace shadowcache {

namespace {

/// Gives the library's stream calls to an AtomicFile.
class AtomicStream final : public Imf::OStream {
public:
    AtomicStream(AtomicFile& file, const std::string& name)
        : Imf::OStream(name.c_str()), file_(file) {}
    void write(const char bytes[], int count) override {
        file_.write(bytes, static_cast<std::size_t>(count));
    }
    std::uint64_t tellp() override { return file_.position(); }
    void seekp(std::uint64_t position) override { file_.seek(position); }

private:
    AtomicFile& file_;
};

/// Gives the library what was written to an AtomicFile.
class WrittenStream final : public Imf::IStream {
public:
    WrittenStream(AtomicFile& file, const std::string& name)
        : Imf::IStream(name.c_str()), file_(file) {
        file_.seek(0);
    }
    bool read(char bytes[], int count) override {
        file_.read(bytes, static_cast<std::size_t>(count));
        return true;
    }
    std::uint64_t tellg() override { return file_.position(); }
    void seekg(std::uint64_t position) override { file_.seek(position); }

private:
    AtomicFile& file_;
};

/// The library (3.1) forgets that it could not compress rows, and leaves them out.
///
/// @throws Error
void requireAllRows(AtomicFile& file, const std::filesystem::path& path) {
    WrittenStream stream(file, path.string());
    if (!Imf::InputFile(stream).isComplete())
        throwFileError(path,
                       "cannot be written: not all rows could be compressed; is memory short?");
}

/// Nearest half; finite values stay finite.
std::vector<half> toHalf(const std::vector<float>& values) {
    constexpr float kMax = 65504.0f;
    std::vector<half> halves;
    halves.reserve(values.size());
    for (const float v : values) {
        halves.emplace_back(std::isfinite(v) ? std::clamp(v, -kMax, kMax) : v);
    }
    return halves;
}

Imath::M44f matrixOf(const PointMatrix& numbers) {
    Imath::M44f matrix;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            matrix[row][column] = numbers[static_cast<std::size_t>(4 * row + column)];
    return matrix;
}

void addView(const ExrView& view, Imf::Header& header) {
    header.pixelAspectRatio() = std::clamp(view.pixelAspect, 1e-6f, 1e6f);  // OpenEXR has no others
    header.screenWindowCenter() = {view.screenCenter[0], view.screenCenter[1]};
    header.screenWindowWidth() = view.screenWidth;
    if (view.worldToCamera) Imf::addWorldToCamera(header, matrixOf(*view.worldToCamera));
    if (view.worldToNdc) Imf::addWorldToNDC(header, matrixOf(*view.worldToNdc));
    if (view.framesPerSecond > 0)
        Imf::addFramesPerSecond(header, Imf::guessExactFps(view.framesPerSecond));
    if (const auto& c = view.chromaticities)
        Imf::addChromaticities(header, Imf::Chromaticities({(*c)[0], (*c)[1]}, {(*c)[2], (*c)[3]},
                                                           {(*c)[4], (*c)[5]}, {(*c)[6], (*c)[7]}));
}

Imf::Header makeHeader(int width, int height, const std::vector<Channel>& channels,
                       const Metadata& metadata, PixelType type, const ExrPlace& place,
                       const ExrView& view) {
    const bool whole = place.frameWidth == 0;
    const Imath::V2i corner(place.x, place.y);
    const Imath::V2i frame(whole ? width : place.frameWidth, whole ? height : place.frameHeight);
    Imf::Header header(Imath::Box2i({0, 0}, frame - Imath::V2i(1)),
                       Imath::Box2i(corner, corner + Imath::V2i(width - 1, height - 1)));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const Channel& channel : channels) {
        header.channels().insert(channel.name,
                                 Imf::Channel(type == PixelType::half ? Imf::HALF : Imf::FLOAT));
    }
    addView(view, header);
    for (const auto& [name, value] : metadata) header.insert(name, Imf::StringAttribute(value));
    return header;
}

}  // namespace

void writeExr(const std::filesystem::path& path, int width, int height,
              const std::vector<Channel>& channels, const Metadata& metadata, PixelType type,
              const ExrPlace& place, const ExrView& view) {
    translated(path, [&] {
        AtomicFile target(path);
        {
            AtomicStream stream(target, path.string());
            Imf::OutputFile output(
                stream, makeHeader(width, height, channels, metadata, type, place, view));
            const auto columns = static_cast<std::size_t>(width);
            std::vector<std::vector<half>> halves;
            Imf::FrameBuffer frame;
            for (const Channel& channel : channels) {
                if (channel.values.size() != columns * static_cast<std::size_t>(height)) {
                    throwFileError(path,
                                   fmt::format("channel {} has {} values, expected width * height",
                                               channel.name, channel.values.size()));
                }
                const void* values = channel.values.data();
                std::size_t stride = sizeof(float);
                if (type == PixelType::half) {
                    values = halves.emplace_back(toHalf(channel.values)).data();
                    stride = sizeof(half);
                }
                frame.insert(
                    channel.name,
                    Imf::Slice::Make(type == PixelType::half ? Imf::HALF : Imf::FLOAT, values,
                                     output.header().dataWindow(), stride, stride * columns));
            }
            output.setFrameBuffer(frame);
            output.writePixels(height);
        }  // the library writes its table of offsets here
        requireAllRows(target, path);
        target.commit();
    });
}

}  // namespace shadowcache
