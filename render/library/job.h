#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/shot/camera_source.h"
#include "common/shot/set_options.h"
#include "render/frame/aov_naming.h"
#include "render/library/picture_options.h"
#include "render/shot/light_plan.h"

namespace shadowcache {

/// What a stage is made of.
struct StageOptions {
    SetOptions set{.mesh = {.shadingNormals = true, .gloss = true}};
    std::filesystem::path cache{};  ///< empty: none
    bool staleOk = false;
    std::uint64_t memory = 0;  ///< bytes for the cache; 0: all of it is read
};

/// What a run of the program does with its pictures.
struct RunOptions {
    std::vector<int> frames{1};
    bool framesGiven = false;     ///< by --frames
    bool bakes = false;           ///< the stage's cache is baked first, unless it is there
    std::string bakeQuality;      ///< as shadowcache-bake has it; empty: its own
    double bakeSpacing = 0;       ///< of the bake; 0: chosen [m]
    bool wait = false;            ///< for the bake, without pictures meanwhile
    std::vector<int> shotFrames;  ///< that a plan of lights is spread over; empty: `frames`

    std::filesystem::path output;
    bool progressive = false;  ///< write the EXR after each pass
    double timeLimit = 0;      ///< seconds for the passes of a frame; 0: none
    bool resume = false;       ///< keep frames that are done
    bool check = false;        ///< look whether all frames are done, write nothing
    bool half = false;
    AovNaming aovNames = AovNaming::shadowcache;
    bool png = false;
    float exposure = 0;
    std::filesystem::path reference;
    std::filesystem::path stats;
    bool explain = false;                          ///< print what to expect, write nothing
    std::optional<std::array<int, 2>> debugPixel;  ///< print this pixel's story, write nothing
    int threads = 0;
    bool list = false;            ///< print what the set has, do not render
    std::filesystem::path mix;    ///< picture whose light groups are mixed; empty: none is
    std::vector<LampGain> gains;  ///< of its groups
    bool serve = false;           ///< answer requests, of which all else is told
    /// Every option as given or defaulted, which frames' files record.
    std::vector<std::pair<std::string, std::string>> settings;
};

/// All that can be asked for: the options of optionTable() write here.
struct RenderJob {
    StageOptions stage;
    LightOptions light;
    CameraOptions camera;
    PictureOptions picture;
    RunOptions run;
};

}  // namespace shadowcache
