#include "render/app/mix_groups.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>

#include "common/base/error.h"
#include "common/base/number_text.h"
#include "common/base/option_checks.h"
#include "common/base/suggestion.h"
#include "common/image/exr.h"
#include "common/image/png.h"
#include "render/frame/aov_channels.h"

namespace shadowcache {

namespace {

/// A channel of a file.
const Channel& channelOf(const ExrFile& file, const std::filesystem::path& path,
                         const std::string& name) {
    const auto found = std::ranges::find(file.channels, name, &Channel::name);
    if (found == file.channels.end())
        throwFileError(path, fmt::format("has no channel {}, expected one of each of its light "
                                         "groups",
                                         name));
    return *found;
}

void requireGroups(const std::filesystem::path& path, std::span<const std::string> groups,
                   std::span<const LampGain> gains) {
    std::string known;
    for (const std::string& group : groups) known += (known.empty() ? "" : ", ") + group;
    for (const LampGain& gain : gains)
        if (std::ranges::none_of(groups, [&](const std::string& group) {
                return matchesPattern(gain.pattern, group);
            }))
            throw Error(fmt::format("--gain {}: {} has no such light group, expected one of {}{}",
                                    gain.pattern, path.string(), known,
                                    suggestion(gain.pattern, {groups.begin(), groups.end()})));
}

/// The groups of a file, each times its gain, behind the picture that they are together.
std::vector<Channel> mixed(const ExrFile& file, const std::filesystem::path& path,
                           std::span<const std::string> groups, std::span<const LampGain> gains) {
    const std::size_t pixels = channelOf(file, path, "R").values.size();
    std::vector<Channel> out;
    for (const char* const name : {"R", "G", "B"})
        out.push_back({name, std::vector<float>(pixels)});
    for (const std::string& group : groups) {
        const Rgb gain = lampGainOf(group, gains);
        for (int k = 0; k < 3; ++k) {
            Channel& sum = out[static_cast<std::size_t>(k)];
            Channel layer = channelOf(file, path, group + "." + sum.name);
            for (std::size_t i = 0; i < pixels; ++i) sum.values[i] += layer.values[i] *= gain[k];
            out.push_back(std::move(layer));
        }
    }
    return out;
}

/// The gains, for the metadata of a mix.
std::string textOf(std::span<const LampGain> gains) {
    std::string text;
    for (const LampGain& gain : gains) {
        text += (text.empty() ? "" : " ") + gain.pattern + "=";
        for (int k = 0; k < 3; ++k)
            text += (k == 0 ? "" : ",") + numberText(static_cast<double>(gain.gain[k]));
    }
    return text;
}

void writePicture(const RenderJob& job, const ExrFile& file, const std::vector<Channel>& channels,
                  const std::vector<float>& alpha) {
    Image image{file.width, file.height, {}};
    for (std::size_t i = 0; i < channels[0].values.size(); ++i)
        image.pixels.emplace_back(channels[0].values[i], channels[1].values[i],
                                  channels[2].values[i]);
    auto png = job.run.output;
    writePng(png.replace_extension(".png"), image, job.run.exposure, alpha);
}

}  // namespace

void mixGroups(const RenderJob& job) {
    const std::filesystem::path& path = job.run.mix;
    requireExtension(job.run.output, ".exr");
    std::error_code no;
    if (std::filesystem::equivalent(path, job.run.output, no))
        throwFileError(job.run.output,
                       "is the picture that is mixed, expected another file to "
                       "write");
    const ExrFile file = readExr(path);
    const auto named = file.metadata.find("shadowcache:" + std::string(kGroupsKey));
    if (named == file.metadata.end())
        throwFileError(path, "has no light groups, expected a picture of --light-groups");
    const std::vector<std::string> groups = groupsOf(named->second);
    requireGroups(path, groups, job.run.gains);
    std::vector<Channel> channels = mixed(file, path, groups, job.run.gains);
    std::vector<float> alpha;
    const auto covered = std::ranges::find(file.channels, "A", &Channel::name);
    if (covered != file.channels.end()) {
        alpha = covered->values;
        channels.push_back(*covered);
    }
    Metadata metadata(file.metadata.begin(), file.metadata.end());
    // With it, the file is not taken for the frame of the settings that it names (--resume).
    metadata.emplace_back("shadowcache:mix", textOf(job.run.gains));
    writeExr(job.run.output, file.width, file.height, channels, metadata,
             job.run.half ? PixelType::half : PixelType::full, file.place, file.view);
    if (job.run.png) writePicture(job, file, channels, alpha);
    std::printf("mix: %zu light groups -> %s\n", groups.size(), job.run.output.c_str());
}

}  // namespace shadowcache
