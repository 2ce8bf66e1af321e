#include "render/app/frame_metadata.h"

#include "common/base/number_text.h"
#include "common/base/text_streams.h"
#include "common/base/version.h"

namespace shadowcache {

namespace {

/// One factor, or three.
std::string gainText(const Vec3d& gain) {
    const auto text = [&](int k) { return numberText(gain[k]); };
    if (gain.x == gain.y && gain.y == gain.z) return text(0);
    return text(0) + "," + text(1) + "," + text(2);
}

}  // namespace

std::vector<std::filesystem::path> inputsOf(const RenderJob& job, const LightPlan::Light& light) {
    std::vector<std::filesystem::path> inputs = job.stage.set.files;
    for (const DynamicFile& file : job.stage.set.dynamic) {
        inputs.push_back(file.mesh);
        inputs.push_back(file.track);
    }
    for (const std::string& text : {job.stage.cache.string(), job.camera.name, light.environment})
        inputs.emplace_back(text);
    return inputs;
}

Metadata frameMetadata(const RenderJob& job, const PictureSettings& settings,
                       std::optional<std::uint64_t> fingerprint, const LightPlan::Light& light,
                       int frame, InputHashes& inputs) {
    Metadata metadata{{"shadowcache:version", kVersion}};
    for (const auto& [name, value] : job.run.settings)
        if (name != "env" && name != "env-rotate" && name != "env-gain" && name != "spp" &&
            name != "camera-rays" && name != "samples" && name != "bounces")
            metadata.emplace_back("shadowcache:" + name, value);
    // --spp, --preview, --target-error and --estimator choose these.
    metadata.emplace_back("shadowcache:camera-rays", std::to_string(settings.options.cameraRays));
    metadata.emplace_back("shadowcache:bounces", settings.options.bounces == kUnlimitedBounces
                                                     ? "unlimited"
                                                     : std::to_string(settings.options.bounces));
    metadata.emplace_back("shadowcache:samples", std::to_string(settings.options.samples));
    metadata.emplace_back("shadowcache:env", light.environment);
    metadata.emplace_back("shadowcache:env-rotate", light.rotation.text());
    metadata.emplace_back("shadowcache:env-gain", gainText(light.gain));
    metadata.emplace_back("shadowcache:bias", biasOf(settings));
    metadata.emplace_back("shadowcache:frame", std::to_string(frame));
    metadata.emplace_back("shadowcache:inputs", inputs.of(inputsOf(job, light)));
    if (fingerprint) {
        TextWriter print;
        print << std::hex << *fingerprint;
        metadata.emplace_back("shadowcache:fingerprint", print.str());
    }
    return metadata;
}

}  // namespace shadowcache
