#include "common/cli/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>

#include "common/base/progress.h"
#include "common/base/suggestion.h"

namespace shadowcache {

namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& text,
                         const std::string& wanted) {
    throw CLI::ParseError(option + " " + text + ": expected " + wanted,
                          CLI::ExitCodes::ValidationError);
}

/// The place of a word in a list.
std::size_t placeOf(const std::string& option, const std::string& word,
                    const std::vector<std::string>& words) {
    const auto found = std::ranges::find(words, word);
    if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
    refuse(option, word,
           "one of " + CLI::detail::join(words, ", ") +
               (word.size() > 1 ? suggestion(word, words) : ""));
}

/// As --help and the completion for bash read it.
std::string typeOf(const std::vector<std::string>& words) {
    return "TEXT:{" + CLI::detail::join(words) + "}";
}

}  // namespace

CLI::Option* addWordOption(CLI::App& app, const std::string& name,
                           const std::vector<std::string>& words,
                           const std::function<void(std::size_t)>& choose,
                           const std::string& description, const std::string& standard) {
    const auto read = [=](const std::string& word) { choose(placeOf(name, word, words)); };
    return app.add_option_function<std::string>(name, read, description)
        ->type_name(typeOf(words))
        ->default_str(standard);
}

CLI::Option* addListOption(CLI::App& app, const std::string& name, std::vector<std::string>& chosen,
                           const std::vector<std::string>& words, const std::string& description) {
    const auto read = [=, &chosen](const std::vector<std::string>& typed) {
        for (const std::string& word : typed) placeOf(name, word, words);
        chosen = typed;
    };
    return app.add_option_function<std::vector<std::string>>(name, read, description)
        ->delimiter(',')
        ->take_all()
        ->type_name(typeOf(words));
}

CLI::Option* addSeedOption(CLI::App& app, std::uint64_t& seed, const std::string& description) {
    const auto read = [&seed](const std::string& text) {
        const char* const end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, seed);
        if (error != std::errc() || stop != end)
            refuse("--seed", text, "a whole number from 0 to below 2^64");
    };
    return app.add_option_function<std::string>("--seed", read, description)
        ->type_name("UINT")
        ->default_str(std::to_string(seed));
}

void addThreadsOption(CLI::App& app, int& threads, const std::string& group) {
    app.add_option("--threads", threads, "Threads; 0: one per core")
        ->capture_default_str()
        ->group(group);
}

void addProgressOption(CLI::App& app, const std::string& group) {
    setProgressStyle(standardProgressStyle());
    addWordOption(
        app, "--progress", namesOf(kProgressStyles),
        [](std::size_t i) { setProgressStyle(kProgressStyles[i].value); },
        "Progress on standard error: none, bar, lines (every ten seconds) or json (one object a "
        "second) [bar on a terminal, lines elsewhere]")
        ->group(group);
}

}  // namespace shadowcache
