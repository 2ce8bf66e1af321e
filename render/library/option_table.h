#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/base/option_row.h"
#include "render/library/job.h"

namespace shadowcache {

// Every option of the renderer, for every way in. One more is one more row here, its effect, and a
// line of the docs page on its subject.

/// What an option is of.
enum class Part {
    set,      ///< RenderJob::stage
    cache,    ///< RenderJob::stage
    light,    ///< RenderJob::light
    camera,   ///< RenderJob::camera
    picture,  ///< RenderJob::picture
    size,     ///< of the film, and the part of it that is rendered: RenderJob::picture
    run,      ///< RenderJob::run: of the command line alone
};

/// The options of a part, whose values are put into `job`, which must live as long.
std::vector<OptionRow> optionRows(Part part, RenderJob& job);

/// All options, in the order of --help-all.
std::vector<OptionRow> optionRows(RenderJob& job);

/// The same, to look up what they are and not to read values.
std::span<const OptionRow> optionTable();

/// A message in which options are called as a door calls them.
std::string inWordsOf(Door door, const std::string& message);

/// Groups that --help shows; --help-all shows all.
inline constexpr const char* kShortHelp[] = {"Set and light", "Camera", "Quality", "Output"};

}  // namespace shadowcache
